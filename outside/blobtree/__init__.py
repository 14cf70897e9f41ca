"""A plain evaluator of BlobTree scenes in f64.

It is written from the pages of docs/; where these are silent, from answers of `jbt eval`.
"""

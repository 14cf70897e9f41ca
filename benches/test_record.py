#!/usr/bin/env python3
"""Tests of record.py: `python3 benches/test_record.py`."""

import tempfile
import unittest
from pathlib import Path
from unittest import mock

import record

ROWS = [
    {"case": "dense-field", "what": "the field, of 200", "primitives": 200, "unit": "primitive and point", "ours_ns": 0.5809,
     "limit_ns": 0.1934, "fidget_jit_ns": 0.9176, "fidget_jit_form": "none", "fidget_vm_ns": 8.25, "walk_ns": 7.72,
     "ratio_limit": 3.005, "ratio_fidget": 1.579, "level": "avx2", "checksum": "ok"},
    {"case": "scaling", "primitives": 20, "unit": "run", "ours_ns": 48850.0, "fidget_jit_ns": 91750.0, "checksum": "ok"},
    {"case": "scaling", "primitives": 2000, "unit": "run", "ours_ns": 4357000.0, "fidget_jit_ns": 12.7e6, "checksum": "ok"},
    {"case": "scaling", "primitives": 20000, "unit": "run", "ours_ns": 43e6, "checksum": "ok"},
    {"case": "train", "primitives": 95, "unit": "evaluation", "ours_ns": 604.7, "published_evaluations_per_second": 2.6e6,
     "checksum": "walk: 1 | 2"},
    {"case": "threads", "what": "meshes", "of": "few", "primitives": 5, "unit": "run", "ours_ns": 2e6, "one_thread_ns": 3e6,
     "ratio_threads": 1.5, "ratio_machine": 1.8, "checksum": "ok"},
    {"case": "threads", "what": "meshes", "of": "many", "primitives": 50, "unit": "run", "ours_ns": 4e6, "checksum": "ok"},
]
COMMENTS = [("command", "compare --json: all"), ("cpu", "Zen")]
README = f"# Title\n\n{record.BEGIN}\n{record.END}\n\nThe rest.\n"


class Records(unittest.TestCase):
    def test_what_is_written_is_read(self):
        comments, rows = record.read_record(record.write_record(COMMENTS, ROWS))
        self.assertEqual(comments, dict(COMMENTS))
        self.assertEqual(rows, [{name: str(value) for name, value in row.items()} for row in ROWS])

    def test_columns_have_one_order(self):
        expected = ["case", "primitives", "ours_ns", "limit_ns", "ratio_limit", "alpha", "zeta", "checksum"]
        self.assertEqual(record.columns([dict.fromkeys(reversed(expected)), {"alpha": 1}]), expected)

    def test_what_is_no_record_is_said(self):
        for text, message in [("", "no column `case`"), ("case,primitives,unit,checksum\n", "no rows"), ("a,b\n1,2\n", "no column")]:
            with self.assertRaisesRegex(record.Failure, message):
                record.read_record(text)

    def test_the_cpu_names_a_folder(self):
        zen = "vendor_id : AMD\ncpu family\t: 25\nmodel\t\t: 1\nmodel name\t: AMD EPYC\nflags\t\t: sse2 fma avx2\n\nmodel : 7\n"
        self.assertEqual(record.cpu(zen, "x86_64"), ("AMD EPYC (family 25, model 1, avx2)", "amd-epyc-family-25-model-1-avx2"))
        xeon = "cpu family : 6\nmodel : 85\nmodel name : Intel(R) Xeon(R) @ 2.00GHz\nflags : fma avx2 avx512f\n"
        self.assertEqual(record.cpu(xeon, "x86_64")[1], "intel-xeon-2-00ghz-family-6-model-85-avx512")
        arm = "processor : 0\nCPU implementer : 0x41\nCPU part : 0xd0c\n"
        self.assertEqual(record.cpu(arm, "aarch64")[1], "0x41-part-0xd0c-aarch64")
        self.assertEqual(record.cpu("", "arm64"), ("unknown (arm64)", "unknown-arm64"))
        self.assertEqual(record.cpu(xeon, "x86_64", "avx2")[1], "intel-xeon-2-00ghz-family-6-model-85-avx2")

    def test_the_level_is_that_of_the_arguments_else_of_the_environment(self):
        environment = {"JBT_LEVEL": "baseline"}
        for arguments, expected in [
            (["--level", "avx2"], "avx2"),
            (["train", "--level=avx512"], "avx512"),
            (["train"], "baseline"),
        ]:
            self.assertEqual(record.bound(arguments, environment), expected)
        self.assertIsNone(record.bound(["--quick"], {}))


class Table(unittest.TestCase):
    def test_numbers_have_three_digits(self):
        times = {0.1234: "0.123 ns", 1.234: "1.23 ns", 12340: "12.3 µs", 123.4e6: "123 ms", 4e9: "4.00 s"}
        self.assertEqual({number: record.time(number) for number in times}, times)
        ratios = {"1234.5": "1,234", "12.34": "12.3", "0.123": "0.12"}
        self.assertEqual({text: record.ratio(text) for text in ratios}, ratios)

    def test_a_case_has_one_row_for_each_of_its_works(self):
        self.assertEqual([row["primitives"] for row in record.chosen(ROWS)], [200, 2000, 95, 5, 50])

    def test_cells(self):
        rows = record.read_record(record.write_record(COMMENTS, ROWS))[1]
        self.assertEqual(record.cells(rows[0]), [
            "`dense-field`", "the field, of 200", "200", "primitive and point", "0.581 ns", "0.193 ns", "0.918 ns", "3.00", "1.58",
            "walk 7.72 ns"])
        self.assertEqual(record.cells(rows[4])[-4:], ["", "", "", "published 385 ns, walk: 1 | 2"])
        self.assertEqual(record.cells(rows[5])[1], "meshes: few")
        self.assertEqual(record.cells(rows[5])[-1], "one thread 3.00 ms, one thread / ours 1.50, of the machine's 1.80")


class Commands(unittest.TestCase):
    """`table` and `check` on a repository of their own."""

    def setUp(self):
        folder = tempfile.TemporaryDirectory()
        self.addCleanup(folder.cleanup)
        root = Path(folder.name).resolve()
        self.record = root / "benches" / "record" / "zen" / "2026-01-02.csv"
        self.readme = root / "README.md"
        places = {"ROOT": root, "RECORDS": root / "benches" / "record", "README": self.readme}
        for name, place in places.items():
            patch = mock.patch.object(record, name, place)
            patch.start()
            self.addCleanup(patch.stop)
        self.readme.write_text(README)
        record.replace(self.record, record.write_record(COMMENTS, ROWS))

    def fails(self, message):
        with self.assertRaisesRegex(record.Failure, message):
            record.check()

    def test_the_table_passes_the_check_until_it_is_edited(self):
        self.fails("names no record")
        record.replace(self.record.with_name("2025-12-31.csv"), "not a record")
        record.write_table(None)
        record.check()
        text = self.readme.read_text()
        self.assertTrue(text.startswith("# Title\n") and text.endswith("\n\nThe rest.\n"))
        self.assertIn("benches/record/zen/2026-01-02.csv", text)
        self.assertIn(r"walk: 1 \| 2", text)
        record.write_table(self.record)
        self.assertEqual(self.readme.read_text(), text)
        self.readme.write_text(text.replace("0.581 ns", "0.181 ns"))
        self.fails("is not that of benches/record/zen/2026-01-02.csv")

    def test_what_is_missing_is_said(self):
        record.write_table(None)
        self.record.write_text("case,primitives,unit,checksum\ndense,many,run,ok\n")
        self.fails("is not a record: a row has no good .*many")
        self.record.unlink()
        self.fails("cannot read the record benches/record/zen/2026-01-02.csv: No such file")
        with self.assertRaisesRegex(record.Failure, "there is no record"):
            record.write_table(None)
        self.readme.write_text("# Title\n")
        self.fails("README.md needs one line")
        self.readme.write_text(f"{record.END}\n{record.BEGIN}\n")
        self.fails("README.md needs one line")


if __name__ == "__main__":
    unittest.main()

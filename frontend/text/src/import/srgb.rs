//! Colours as screens have them (IEC 61966-2-1).

/// The light of an encoded number.
pub(super) fn decoded(encoded: f64) -> f64 {
    if encoded <= 0.04045 { encoded / 12.92 } else { ((encoded + 0.055) / 1.055).powf(2.4) }
}

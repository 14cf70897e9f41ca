//! Surface radii: the radius at which a primitive alone meets the iso-value of its model.

use crate::falloff::Falloff;
use crate::field::plain;
use crate::report::Fault;

/// The support radius of a primitive whose surface alone has this radius: `r / sqrt(s)`, see
/// [`surface_scale`].
pub(super) fn support_radius(radius: f64, falloff: Falloff, strength: f64, iso: f64) -> Result<f64, Fault> {
    if radius.is_nan() || (iso / strength).is_nan() {
        return Ok(f64::NAN);
    }
    if radius <= 0.0 {
        let message = format!("the surface radius is {}", plain(radius));
        return Err(Fault { message, help: Some("expected a number above 0") });
    }
    Ok(radius / surface_scale(falloff, strength, iso)?)
}

/// What divides the surface radius of a primitive alone to give that of its support: the root of the s that
/// solves `falloff(s) = iso / strength`, the squared distance over the squared support radius. A NaN if one
/// of the numbers is.
pub(super) fn surface_scale(falloff: Falloff, strength: f64, iso: f64) -> Result<f64, Fault> {
    let level = iso / strength;
    if level.is_nan() {
        return Ok(f64::NAN);
    }
    if !(level > 0.0 && level < 1.0) {
        let (iso, strength) = (plain(iso), plain(strength));
        return Err(Fault {
            message: format!("with strength {strength} the primitive has no surface at iso {iso}"),
            help: Some("expected a strength above iso, or `radius`, the radius of the support"),
        });
    }
    Ok(falloff.inverse(level).sqrt())
}

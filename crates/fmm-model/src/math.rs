//! Elementary functions of `f64`: those of the standard library, or those of `libm` where there is none.

macro_rules! functions {
    ($($name:ident($($argument:ident),+) as $pure:ident;)+) => {$(
        #[inline]
        pub(crate) fn $name($($argument: f64),+) -> f64 {
            #[cfg(feature = "std")]
            return f64::$name($($argument),+);
            #[cfg(not(feature = "std"))]
            return libm::$pure($($argument),+);
        }
    )+};
}

functions! {
    exp(x) as exp;
    ln(x) as log;
    log10(x) as log10;
    sqrt(x) as sqrt;
    sin(x) as sin;
    cos(x) as cos;
    tan(x) as tan;
    atan(x) as atan;
    atan2(y, x) as atan2;
    sinh(x) as sinh;
    cosh(x) as cosh;
    tanh(x) as tanh;
    floor(x) as floor;
    round(x) as round;
    powf(base, exponent) as pow;
}

#[inline]
pub(crate) fn sin_cos(x: f64) -> (f64, f64) {
    #[cfg(feature = "std")]
    return x.sin_cos();
    #[cfg(not(feature = "std"))]
    return libm::sincos(x);
}

#[inline]
pub(crate) fn powi(base: f64, exponent: i32) -> f64 {
    #[cfg(feature = "std")]
    return base.powi(exponent);
    #[cfg(not(feature = "std"))]
    return libm::pow(base, f64::from(exponent));
}

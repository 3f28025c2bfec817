//! The function language of RADIANCE (`.cal` files).

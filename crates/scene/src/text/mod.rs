//! RADIANCE scene text: items and their arguments, then surfaces, materials and lights.

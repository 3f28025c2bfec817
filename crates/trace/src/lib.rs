//! Light transport: rays against geometry, light sources, cameras, integrators, film.

pub mod accumulate;
pub mod bvh;
pub mod camera;
mod follow;
pub mod function;
mod glint;
mod lanes;
pub mod light;
mod lit;
pub mod material;
pub mod passage;
pub mod path;
pub mod pattern;
mod reflect;
pub mod render;
pub mod sampler;
pub mod scene;
pub(crate) mod screen;
pub mod sensor;
pub mod shape;
pub(crate) mod shared;
pub mod studio;
pub mod travel;
mod unscattered;
pub mod vector;
mod veil;
pub mod view_text;

//! Light transport: rays against geometry, light sources, cameras, integrators, film.

pub mod accumulate;
pub mod bvh;
pub mod camera;
pub mod light;
pub mod material;
pub mod path;
pub mod pattern;
pub mod render;
pub mod sampler;
pub mod scene;
pub mod sensor;
pub mod shape;
pub mod studio;
pub mod vector;
pub mod view_text;

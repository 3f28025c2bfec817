//! Materials of functions and data: beside RADIANCE, and as the closed forms that they are.

use glam::Vec3;
use gonio_trace::path::Limits;
use gonio_trace::sampler::Sampler;
use gonio_trace::scene::Scene;

use crate::{close, load_with, look, look_at, parts_of};

/// Lobes about the mirrored and the unbent direction, and functions of each variable.
const CAL: &str = "mx = Dx + 2*RdotP*NxP; my = Dy + 2*RdotP*NyP; mz = Dz + 2*RdotP*NzP;
glossy(x,y,z) = exp(-((x-mx)^2+(y-my)^2+(z-mz)^2)/A5)/(PI*A5) * (1+.3*Px);
through(x,y,z) = if(x*NxP+y*NyP+z*NzP, exp(-((x-mx)^2+(y-my)^2+(z-mz)^2)/A7)/(PI*A7),
    exp(-((x-Dx)^2+(y-Dy)^2+(z-Dz)^2)/A8)/(PI*A8));
turned(x,y,z) = if(x, .2*CrP*x, .05) + .03 + .02*Rdot;
green(x,y,z) = .1 + .1*Nz*y;
blue(x,y,z) = if(x*NxP+y*NyP+z*NzP, .3, .1) * abs(z);
front = if(Rdot, .2, .05);
data(v,x,y,z) = v*(1+.1*x);
cosine(x,y,z) = abs(x*NxP+y*NyP+z*NzP);
up(x,y,z) = z;
power(x,y,z) = (AN+2)/(2*PI) * abs(x*NxP+y*NyP+z*NzP)^AN; AN = arg(arg(0));
half(x,y,z) = if(x*NxP+y*NyP+z*NzP, .5/PI, 0);";
const DATA: &str = "2\n0 1 3\n-1 1 2\n0 .1 .2 .4 .3 .9\n";
const FILES: [(&str, &str); 2] = [("g.cal", CAL), ("g.dat", DATA)];
const COLOUR: &str = "void colorfunc c 4 .5+.1*Px 1 .7 . 0 0\n";
const BUMP: &str = "void texfunc c 4 .1*Px .1 .05*Py . 0 0\n";
const SHEET: &str = "\nm polygon p 0 0 12 -5 -5 -.3 5 -5 .2 5 5 .5 -5 5 0\n";
const RAYS: [([f32; 3], [f32; 3]); 4] = [
    ([0., 0., 3.], [0.02, 0.01, -1.]),
    ([-0.8, -1.3, 2.], [0.8, 1.3, -2.]),
    ([0.5, 0.9, -2.], [-0.3, -0.7, 2.]),
    ([-0.5, -1.5, 2.2], [0.6, 1.2, -2.]),
];

/// Radiance under two suns, one before and one behind the sheet; each alone, so that nothing is left to chance.
fn under_suns(text: &str, k: usize) -> Vec3 {
    let mut sum = Vec3::ZERO;
    for sun in [".3 .5 .8", ".1 -.4 -.8"] {
        let sun = format!("void light sun 0 0 3 1e6 1.2e6 .8e6\nsun source s 0 0 4 {sun} .1\n");
        let parts = parts_of(load_with(&(sun + text), &FILES));
        let scene = Scene::new(parts).unwrap();
        let (from, to) = RAYS[k];
        for index in 0..16 {
            let mut sampler = Sampler::new(1, 0, index);
            let direction = Vec3::from(to).normalize();
            sum += scene.radiance(Vec3::from(from), direction, &Limits::default(), &mut sampler) / 16.0;
        }
    }
    sum
}

#[test]
fn functions_and_data_scatter_the_light_of_the_sun_as_in_radiance() {
    // What `rtrace -ab 0 -lw 1e-7 -dt 0 -dj 0 -ds 0` of RADIANCE 6 prints for the four rays.
    let cases: [(String, [[f32; 3]; 4]); 8] = [
        (
            format!("{COLOUR}c plasfunc m 2 glossy g.cal 0 5 .3 .4 .5 .2 .1{SHEET}"),
            [
                [8.077481e-02, 2.378643e-01, 1.396534e-01],
                [1.150523e+00, 1.523204e+00, 9.965464e-01],
                [8.577457e-01, 1.186534e+00, 7.695870e-01],
                [1.002525e+00, 1.342733e+00, 8.762329e-01],
            ],
        ),
        (
            format!("{COLOUR}c metfunc m 4 glossy g.cal -rz 40 0 5 .3 .4 .5 .2 .1{SHEET}"),
            [
                [7.314907e-02, 2.313963e-01, 1.349812e-01],
                [2.296619e-01, 7.406178e-01, 4.320270e-01],
                [2.057963e-01, 6.353076e-01, 3.705961e-01],
                [2.082764e-01, 6.495693e-01, 3.789154e-01],
            ],
        ),
        (
            format!("{COLOUR}c transfunc m 2 through g.cal 0 8 .3 .4 .5 .2 .6 .7 .1 .2{SHEET}"),
            [
                [1.070450e-01, 3.212676e-01, 1.882900e-01],
                [1.136523e+00, 1.452514e+00, 9.565719e-01],
                [7.823815e-01, 1.029898e+00, 6.741876e-01],
                [9.405548e-01, 1.216524e+00, 7.991159e-01],
            ],
        ),
        (
            format!(
                "{COLOUR}c BRTDfunc m 14 0 0 0 0 0 0 turned green blue g.cal -rx 30 -s 2 0 9 .1 .2 .3 .3 .2 .1 .2 .25 .3{SHEET}"
            ),
            [
                [3.763342e-01, 7.991263e-01, 5.035097e-01],
                [3.591141e-01, 7.991263e-01, 5.035097e-01],
                [2.916524e-01, 7.944146e-01, 4.799010e-01],
                [3.675541e-01, 7.991263e-01, 5.035097e-01],
            ],
        ),
        (
            format!(
                "{BUMP}c BRTDfunc m 14 0 0 0 0 0 0 turned green blue g.cal -rx 30 -s 2 0 9 .1 .2 .3 .3 .2 .1 .2 .25 .3{SHEET}"
            ),
            [
                [5.815449e-01, 8.467017e-01, 6.287767e-01],
                [5.661143e-01, 8.447272e-01, 6.275743e-01],
                [5.525738e-01, 8.450224e-01, 5.686684e-01],
                [5.704347e-01, 8.484915e-01, 6.299177e-01],
            ],
        ),
        (
            format!("{BUMP}c transfunc m 2 through g.cal 0 8 .3 .4 .5 .2 .6 .7 .1 .2{SHEET}"),
            [
                [2.698155e-01, 4.055639e-01, 3.248994e-01],
                [1.089440e+00, 1.344645e+00, 9.213086e-01],
                [1.059484e+00, 1.310627e+00, 8.999149e-01],
                [1.070152e+00, 1.322069e+00, 9.066371e-01],
            ],
        ),
        (
            format!("void plasdata m 7 data g.dat g.cal cosine up -rx 20 0 4 .3 .4 .5 .2{SHEET}"),
            [
                [3.675652e-01, 4.978467e-01, 3.697434e-01],
                [3.675652e-01, 4.978467e-01, 3.697434e-01],
                [3.121376e-01, 4.388724e-01, 3.354530e-01],
                [3.675652e-01, 4.978467e-01, 3.697434e-01],
            ],
        ),
        (
            format!("void transdata m 7 data g.dat g.cal cosine up -rx 20 0 6 .3 .4 .5 .2 .6 .7{SHEET}"),
            [
                [3.876412e-01, 5.299681e-01, 3.965113e-01],
                [3.876412e-01, 5.299681e-01, 3.965113e-01],
                [3.549473e-01, 5.073678e-01, 3.925326e-01],
                [3.876412e-01, 5.299681e-01, 3.965113e-01],
            ],
        ),
    ];
    for (text, wanted) in cases {
        for (k, wanted) in wanted.into_iter().enumerate() {
            let (found, wanted) = (under_suns(&text, k), Vec3::from(wanted));
            let off = (found / wanted - 1.0).abs().max_element();
            assert!(off < 1e-3, "ray {k} of {text}: {found}, wanted {wanted}");
        }
    }
}

#[test]
fn mirrored_and_straight_parts_of_a_brtdfunc_are_those_of_radiance() {
    // What `rtrace -ab 1 -ad 65536 -lw 1e-7` prints for the first and third ray under two half skies.
    let text = "void glow g 0 0 4 1 2 3 0\ng source up 0 0 4 0 0 1 180\nvoid glow h 0 0 4 .5 .2 .1 0\n\
                h source down 0 0 4 0 0 -1 180\nvoid BRTDfunc m 10 front .1 .3 front .4*abs(Pz)+.1 .2 0 0 0 g.cal 0 9 \
                .1 .2 .3 .4 .3 .2 .05 .1 .15";
    for (k, wanted) in [(0, [0.42506, 0.6484, 1.8341]), (2, [0.32532, 0.57168, 1.09994])] {
        let (from, along) = (Vec3::from(RAYS[k].0), Vec3::from(RAYS[k].1));
        let parts = parts_of(load_with(&format!("{text}{SHEET}"), &FILES));
        let found = look_at(parts, from, from + along);
        assert!(found.1 < 0.005 * wanted[1], "{found:?}");
        close(found, Vec3::from(wanted));
    }
}

#[test]
fn the_sun_passes_a_brtdfunc_straight_as_in_radiance() {
    let text = "void light sun 0 0 3 1e6 1.2e6 .8e6\nsun source s 0 0 4 .3 .5 .8 .1\n\
                void BRTDfunc m 10 0 0 0 front .4*abs(Px)+.1 .2 0 0 0 g.cal 0 9 0 0 0 0 0 0 0 0 0\n\
                m polygon p 0 0 12 -5 -5 1 5 -5 1 5 5 1 -5 5 1\nvoid plastic w 0 0 5 .5 .5 .5 0 0\n\
                w polygon f 0 0 12 -5 -5 0 5 -5 0 5 5 0 -5 5 0\n";
    for (from, along, wanted) in [
        (
            [0., 0., 0.5],
            [0.02, 0.01, -1.],
            [1.538550e-02, 9.379002e-02, 4.923361e-02],
        ),
        (
            [-1.5, -1., 2.],
            [0.6, 0.3, -2.],
            [3.077101e-03, 6.639152e-02, 9.846722e-03],
        ),
    ] {
        let from = Vec3::from(from);
        let found = look_at(parts_of(load_with(text, &FILES)), from, from + Vec3::from(along));
        close(found, Vec3::from(wanted));
    }
}

const EVEN: &str = "void glow g 0 0 4 1 1 1 0\ng source sky 0 0 4 0 0 1 360\n";
const DISK: &str = "\nm ring f 0 0 8 0 0 0 0 0 1 0 5\n";

#[test]
fn a_lambertian_written_as_functions_is_plastic() {
    let lit = format!(
        "{EVEN}void light sun 0 0 3 1e6 1e6 1e6\nsun source s 0 0 4 .3 .5 .8 .1\n\
         void plastic w 0 0 5 .3 .6 .1 0 0\nw sphere b 0 0 4 1 0 .8 .5\n"
    );
    let (from, to) = (Vec3::new(-1.0, 0.0, 2.0), Vec3::ZERO);
    let seen = |material: &str| {
        look_at(
            parts_of(load_with(&format!("{lit}void {material}{DISK}"), &FILES)),
            from,
            to,
        )
    };
    let (plastic, error) = look(&format!("{lit}void plastic m 0 0 5 .5 .5 .5 0 0{DISK}"), from, to);
    for material in [
        "BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . 0 9 .5 .5 .5 .5 .5 .5 0 0 0",
        "BRTDfunc m 10 0 0 0 0 0 0 half half half g.cal 0 9 0 0 0 0 0 0 0 0 0",
        "plasfunc m 2 half g.cal 0 4 0 0 0 1",
        "metfunc m 2 half g.cal 0 4 1 1 1 1",
    ] {
        let (found, other) = seen(material);
        close((found, error + other), plastic);
    }
}

#[test]
fn lobes_under_an_even_sky_give_what_their_closed_form_says() {
    // A lobe (n + 2)/(2 pi) cos^n reflects 1 in all directions together.
    let colour = Vec3::new(1.0, 0.5, 0.2);
    for (power, from) in [(1, Vec3::new(0.3, 0.2, 1.0)), (8, Vec3::new(1.0, 0.0, -0.5))] {
        let seen = |material: &str| {
            let text = format!("{EVEN}void {material} {power}{DISK}");
            look_at(parts_of(load_with(&text, &FILES)), from, Vec3::ZERO)
        };
        close(
            seen("plasfunc m 2 power g.cal 0 5 1 .5 .2 .3"),
            0.7 * colour + 0.3,
        );
        close(seen("metfunc m 2 power g.cal 0 5 1 .5 .2 .3"), colour);
        let trans = "transfunc m 2 power g.cal 0 7 1 .5 .2 .3 .6 .5";
        // 0.3 reflected by the lobe, 0.7 of the rest in the colour, on both sides.
        close(seen(trans), 0.7 * colour + 0.3);
    }
}

#[test]
fn arguments_that_make_no_material_are_refused_by_file_and_line() {
    for (material, wanted) in [
        ("plasfunc m 1 glossy 0 5 1 1 1 0 .1", "string arguments: found 1"),
        ("plasfunc m 2 glossy g.cal 0 3 1 1 1", "real arguments: found 3"),
        (
            "plasfunc m 2 glossy g.cal 0 5 1 1 1 1.5 .1",
            "real argument 4: found 1.5",
        ),
        ("metfunc m 2 glossy no.cal 0 5 1 1 1 .5 .1", "file"),
        ("metfunc m 2 missing g.cal 0 5 1 1 1 .5 .1", "function"),
        ("metfunc m 2 glossy g.cal 0 4 1 1 1 .5", "function"),
        (
            "transfunc m 2 through g.cal 0 5 1 1 1 0 .5",
            "real arguments: found 5",
        ),
        (
            "transfunc m 4 through g.cal -q 3 0 8 1 1 1 0 .5 .5 .1 .1",
            "transform",
        ),
        (
            "plasdata m 5 data g.dat g.cal cosine up 0 0",
            "real arguments: found 0",
        ),
        (
            "plasdata m 4 data g.dat g.cal cosine 0 4 1 1 1 0",
            "string arguments: found 4",
        ),
        ("plasdata m 5 data no.dat g.cal cosine up 0 4 1 1 1 0", "file"),
        (
            "BRTDfunc m 9 0 0 0 0 0 0 0 0 0 0 9 0 0 0 0 0 0 0 0 0",
            "string arguments: found 9",
        ),
        (
            "BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . 0 8 0 0 0 0 0 0 0 0",
            "real arguments: found 8",
        ),
        (
            "BRTDfunc m 10 0 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 -1",
            "real argument 9: found -1",
        ),
        (
            "BRTDfunc m 10 A10 0 0 0 0 0 0 0 0 . 0 9 0 0 0 0 0 0 0 0 0",
            "function",
        ),
    ] {
        let text = format!("\nvoid {material}{DISK}");
        match load_with(&text, &FILES) {
            Ok(_) => panic!("read: {material}"),
            Err(e) => assert!(
                e.starts_with(&format!("a.rad, line 2: {wanted}")),
                "{material}: {e}"
            ),
        }
    }
}

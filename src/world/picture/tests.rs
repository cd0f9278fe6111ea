//! Lookups and levels against plain models of them.

use proptest::prelude::*;

use super::*;
use crate::color::Transfer;

const WRAPS: [Wrap; 3] = [Wrap::Repeat, Wrap::Clamp, Wrap::Mirror];

/// The texel in any column and row of the plane that copies of the picture fill.
fn tiled(picture: &Picture, wrap: Wrap, column: i64, row: i64) -> [f64; 4] {
    let wrapped = |i: i64, n: u32| {
        let n = i64::from(n);
        match wrap {
            Wrap::Repeat => i.rem_euclid(n),
            Wrap::Clamp => i.clamp(0, n - 1),
            Wrap::Mirror => (0..n)
                .find(|j| [*j, 2 * n - 1 - j].contains(&i.rem_euclid(2 * n)))
                .unwrap(),
        }
    };
    let [width, height] = picture.size();
    let [column, row] = [wrapped(column, width), wrapped(row, height)];
    let Texels::Floats(texels) = &picture.texels else {
        unreachable!("a picture of floats")
    };
    texels[(row * i64::from(width) + column) as usize].map(f64::from)
}

/// The reference: all texels of the plane near a point, each with the product of two
/// triangles as its weight.
fn expected(picture: &Picture, wrap: Wrap, [u, v]: [f32; 2]) -> [f64; 4] {
    let [width, height] = picture.size().map(f64::from);
    let [x, y] = [f64::from(u) * width, (1.0 - f64::from(v)) * height];
    let mut sum = [0.0; 4];
    for row in y.floor() as i64 - 2..=y.floor() as i64 + 2 {
        for column in x.floor() as i64 - 2..=x.floor() as i64 + 2 {
            let weight = |at: f64, i: i64| (1.0 - (at - 0.5 - i as f64).abs()).max(0.0);
            let weight = weight(x, column) * weight(y, row);
            for (sum, channel) in sum.iter_mut().zip(tiled(picture, wrap, column, row)) {
                *sum += weight * channel;
            }
        }
    }
    sum
}

prop_compose! {
    fn pictures()(size in [1_u32..9, 1_u32..9])(
        texels in prop::collection::vec([0.0_f32..4.0, 0.0_f32..4.0, 0.0_f32..4.0, 0.0_f32..1.0],
            (size[0] * size[1]) as usize),
        size in Just(size),
    ) -> Picture {
        Picture::new(size, Texels::Floats(texels)).unwrap()
    }
}

proptest! {
    #[test]
    fn bilinear_lookups_are_sums_of_tents(
        picture in pictures(),
        wrap in prop::sample::select(&WRAPS[..]),
        at in [-3.0_f32..4.0, -3.0_f32..4.0],
    ) {
        let sampling = Sampling { filter: TexelFilter::Bilinear, wrap };
        let found = picture.at(sampling, at, 9.0);
        for (found, expected) in found.into_iter().zip(expected(&picture, wrap, at)) {
            prop_assert!((f64::from(found) - expected).abs() < 1e-4, "{found} {expected}");
        }
    }

    #[test]
    fn any_numbers_find_a_texel(
        picture in pictures(),
        wrap in prop::sample::select(&WRAPS[..]),
        bits in [any::<u32>(), any::<u32>(), any::<u32>()],
    ) {
        let [u, v, footprint] = bits.map(f32::from_bits);
        for filter in [TexelFilter::Trilinear, TexelFilter::Bilinear, TexelFilter::Nearest] {
            let found = picture.at(Sampling { filter, wrap }, [u, v], footprint);
            prop_assert!(found.iter().all(|channel| (0.0..=4.0001).contains(channel)));
        }
    }
}

/// The reference: the mean of the texels of the rectangle from `from` to `to`, in fractions of the
/// picture, by a grid of points.
fn mean(picture: &Picture, from: [f64; 2], to: [f64; 2]) -> [f64; 4] {
    const N: usize = 360;
    let mut sum = [0.0; 4];
    for i in 0..N * N {
        let place = |k: usize, j: usize| {
            let t = (j as f64 + 0.5) / N as f64;
            let n = f64::from(picture.size()[k]);
            ((from[k] + t * (to[k] - from[k])) * n) as i64
        };
        let found = tiled(picture, Wrap::Clamp, place(0, i % N), place(1, i / N));
        for (sum, channel) in sum.iter_mut().zip(found) {
            *sum += channel / (N * N) as f64;
        }
    }
    sum
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(32))]

    #[test]
    fn each_level_has_the_means_of_the_one_before(picture in pictures()) {
        for pair in picture.levels.windows(2) {
            let before: Vec<_> = (0..pair[0].size[0] * pair[0].size[1])
                .map(|i| picture.get(pair[0].first + i as usize))
                .collect();
            let before = Picture::new(pair[0].size, Texels::Floats(before)).unwrap();
            let [columns, rows] = pair[1].size;
            for i in 0..columns * rows {
                let at = |i: u32, n: u32| [i, i + 1].map(|i| f64::from(i) / f64::from(n));
                let ([left, right], [top, bottom]) = (at(i % columns, columns), at(i / columns, rows));
                let expected = mean(&before, [left, top], [right, bottom]);
                let found = picture.get(pair[1].first + i as usize);
                for (found, expected) in found.into_iter().zip(expected) {
                    prop_assert!((f64::from(found) - expected).abs() < 0.02, "{found} {expected}");
                }
            }
        }
    }
}

#[test]
fn a_footprint_of_all_has_the_mean_of_the_light() {
    for (level, light) in [(255_u8, 1.0), (40, 0.021_219), (12, 0.003_677)] {
        for size in [[12, 12], [9, 4], [96, 1]] {
            // One texel of three has light.
            let n = (size[0] * size[1]) as usize;
            let gray = |i: usize| level * u8::from(i.is_multiple_of(3));
            let grays = || (0..n).map(gray);
            let of_all = |gray: u8| [gray, gray, gray, 51];
            for texels in [
                Texels::Gray(grays().collect(), Transfer::Srgb),
                Texels::Rgb(grays().map(|gray| [gray; 3]).collect(), Transfer::Srgb),
                Texels::Bytes(grays().map(of_all).collect(), Transfer::Srgb),
            ] {
                let has_opacity = matches!(texels, Texels::Bytes(..));
                let picture = Picture::new(size, texels).unwrap();
                let [r, g, b, opacity] = picture.at(Sampling::default(), [0.3, 0.6], 50.0);
                let ratio = [r, g, b].map(|found| 3.0 * found / light);
                assert!(ratio.iter().all(|of| (of - 1.0).abs() < 5e-4), "{ratio:?}");
                let expected = if has_opacity { 0.2 } else { 1.0 };
                assert!((opacity - expected).abs() < 1e-4, "{opacity}");
            }
        }
    }
}

/// The smaller copies have a third of the texels, and two bytes a channel.
#[test]
fn smaller_copies_take_two_thirds_of_the_bytes_again() {
    let picture = |texels| Picture::new([64, 64], texels).unwrap().n_bytes();
    let n = 64 * 64;
    let smaller = (n - 1) / 3;
    let of_rgb = picture(Texels::Rgb(vec![[7; 3]; n as usize], Transfer::Srgb));
    assert_eq!(of_rgb, 3 * n + 6 * smaller);
    let of_gray = picture(Texels::Gray(vec![7; n as usize], Transfer::Srgb));
    assert_eq!(of_gray, n + 2 * smaller);
}

#[test]
fn a_footprint_between_levels_mixes_them() {
    let texels = (0..64).map(|i| [i as f32; 4]).collect();
    let picture = Picture::new([8, 8], Texels::Floats(texels)).unwrap();
    let sampling = Sampling::default();
    for (footprint, finer, place) in [
        (0.01, 0, 0.0),
        (0.125, 0, 0.0),
        (0.3, 1, 0.263),
        (2.0, 3, 0.0),
    ] {
        let level = |i: usize| picture.between(picture.levels[i], [Wrap::Repeat; 2], [0.3, 0.4])[0];
        let [fine, coarse] = [level(finer), level((finer + 1).min(3))];
        let expected = fine + (coarse - fine) * place;
        let [found, ..] = picture.at(sampling, [0.3, 0.6], footprint);
        assert!(
            (found - expected).abs() < 0.02,
            "{footprint}: {found} {expected}"
        );
    }
}

#[test]
fn rows_go_down_and_v_goes_up() {
    let rows = [[0.0, 1.0], [2.0, 3.0], [4.0, 5.0]];
    let texels = rows.concat().into_iter().map(|gray| [gray; 4]).collect();
    let picture = Picture::new([2, 3], Texels::Floats(texels)).unwrap();
    for (filter, third) in [
        (TexelFilter::Nearest, 1.0 / 3.0),
        (TexelFilter::Bilinear, 1.0 / 3.0),
    ] {
        let sampling = Sampling {
            filter,
            wrap: Wrap::Clamp,
        };
        for (row, grays) in rows.iter().enumerate() {
            for (column, gray) in grays.iter().enumerate() {
                let u = 0.5 * (column as f32 + 0.5);
                let v = 1.0 - third * (row as f32 + 0.5);
                let [found, ..] = picture.at(sampling, [u, v], 0.0);
                assert!((found - gray).abs() < 1e-5, "{column} {row}: {found}");
            }
        }
    }
}

#[test]
fn sides_are_limited() {
    let texels = |n| Texels::Floats(vec![[0.0; 4]; n]);
    assert!(Picture::new([0, 1], texels(0)).is_none());
    assert!(Picture::new([2, 1], texels(1)).is_none());
    assert!(Picture::new([1, Picture::MAX_SIDE], texels(1 << 16)).is_some());
    assert!(Picture::new([1, Picture::MAX_SIDE + 1], texels((1 << 16) + 1)).is_none());
}

#[test]
fn pictures_with_too_many_texels_are_not_for_devices() {
    let mut picture = Picture::new([2, 1], Texels::Floats(vec![[0.5; 4]; 2])).unwrap();
    assert_eq!(
        picture.words().unwrap().take(7).collect::<Vec<_>>(),
        [2, 2, 1, 0, 1, 1, 2]
    );
    // As after a whole picture of 2^16 x 2^16 texels.
    picture.levels[1].first = 1 << 32;
    assert_eq!(
        picture.words().err(),
        Some("a picture of more than 2^32 texels")
    );
}

//! Every operation of every level against the scalar level, bit for bit, on random and on awkward numbers.
//!
//! A NaN that arithmetic makes has no agreed payload: it counts as equal to any other NaN. What only moves or selects
//! lanes must keep a NaN's bits.

use homcull_simd::{Kernel, Level, Simd};

/// SplitMix64: the tests' own, so that seeds mean the same for ever.
struct Random(u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    fn below(&mut self, n: usize) -> usize {
        (self.bits() % n as u64) as usize
    }

    fn float(&mut self) -> f32 {
        const SPECIAL: [f32; 24] = [
            0.0,
            -0.0,
            1.0,
            -1.0,
            0.5,
            -0.5,
            1.5,
            2.5,
            f32::NAN,
            f32::INFINITY,
            f32::NEG_INFINITY,
            f32::MIN_POSITIVE,
            -f32::MIN_POSITIVE,
            1e-45,
            -1e-45,
            1e-40,
            f32::MAX,
            f32::MIN,
            2_147_483_648.0,
            -2_147_483_648.0,
            2_147_483_520.0,
            8_388_607.5,
            8_388_608.5,
            -8_388_608.5,
        ];
        match self.below(4) {
            0 => SPECIAL[self.below(SPECIAL.len())],
            1 => f32::from_bits(self.bits() as u32),
            2 => (self.bits() as i32 as f32) / 512.0,
            _ => (self.bits() >> 40) as f32 / 16_777_216.0,
        }
    }

    fn integer(&mut self) -> i32 {
        const SPECIAL: [i32; 12] = [0, 1, -1, i32::MIN, i32::MAX, i32::MIN + 1, 31, 32, 255, 65_536, -65_536, 46_341];
        match self.below(3) {
            0 => SPECIAL[self.below(SPECIAL.len())],
            1 => self.bits() as i32,
            _ => self.bits() as i8 as i32,
        }
    }

    fn short(&mut self) -> i16 {
        const SPECIAL: [i16; 7] = [0, 1, -1, i16::MIN, i16::MAX, 4681, -4681];
        if self.below(4) == 0 { SPECIAL[self.below(SPECIAL.len())] } else { self.bits() as i16 >> self.below(12) }
    }
}

/// Inputs of one round.
struct Inputs {
    f: [[f32; 16]; 3],
    i: [[i32; 16]; 2],
    bytes: [u8; 16],
    mask: u16,
    table_f: [f32; 32],
    table_i: [i32; 32],
    /// Indices below 32, where the mask is set.
    index: [i32; 16],
    edges: [[i16; 3]; 3],
}

impl Inputs {
    fn new(r: &mut Random) -> Inputs {
        let mask = match r.below(8) {
            0 => 0,
            1 => 0xFFFF,
            _ => r.bits() as u16,
        };
        Inputs {
            f: std::array::from_fn(|_| std::array::from_fn(|_| r.float())),
            i: std::array::from_fn(|_| std::array::from_fn(|_| r.integer())),
            bytes: std::array::from_fn(|_| r.bits() as u8),
            mask,
            table_f: std::array::from_fn(|_| r.float()),
            table_i: std::array::from_fn(|_| r.integer()),
            index: std::array::from_fn(|l| if mask >> l & 1 != 0 { r.below(32) as i32 } else { r.integer() }),
            edges: std::array::from_fn(|_| std::array::from_fn(|_| r.short())),
        }
    }
}

/// What each operation gave, as words.
type Results = Vec<(&'static str, Vec<u64>)>;

fn float_word(v: f32) -> u64 {
    if v.is_nan() { u64::MAX } else { v.to_bits().into() }
}

fn double_word(v: f64) -> u64 {
    if v.is_nan() { u64::MAX } else { v.to_bits() }
}

/// Lanes of floats that arithmetic made: all NaN are one.
fn computed<S: Simd>(s: S, v: S::F) -> Vec<u64> {
    let mut to = [0.0; 16];
    s.store_f(v, &mut to);
    to.map(float_word).to_vec()
}

/// Lanes of floats that were moved: NaN keep their bits.
fn moved<S: Simd>(s: S, v: S::F) -> Vec<u64> {
    let mut to = [0.0; 16];
    s.store_f(v, &mut to);
    to.map(|v| v.to_bits().into()).to_vec()
}

fn integers<S: Simd>(s: S, v: S::I) -> Vec<u64> {
    let mut to = [0; 16];
    s.store_i(v, &mut to);
    to.map(|v| v as u32 as u64).to_vec()
}

fn doubles<S: Simd>(s: S, v: S::D) -> Vec<u64> {
    let mut to = [0.0; 16];
    s.store_d(v, &mut to);
    to.map(double_word).to_vec()
}

struct Floats<'a>(&'a Inputs);

impl Kernel for Floats<'_> {
    type Output = Results;

    fn run<S: Simd>(self, s: S) -> Results {
        let Inputs { f, mask, table_f, index, .. } = self.0;
        let (a, b) = (s.load_f(&f[0]), s.load_f(&f[1]));
        let mut packed = [0.0; 16];
        s.compress_f(*mask, a, &mut packed);
        let packed = packed[..mask.count_ones() as usize].iter().map(|v| u64::from(v.to_bits())).collect();
        let numbers = f[0].map(|v| if v.is_nan() { 1.0 } else { v + 0.0 });
        let numbers = s.load_f(&numbers);
        let index = s.load_i(index);
        vec![
            ("splat_f", moved(s, s.splat_f(f[0][0]))),
            ("load_f, store_f", moved(s, a)),
            ("add_f", computed(s, s.add_f(a, b))),
            ("sub_f", computed(s, s.sub_f(a, b))),
            ("mul_f", computed(s, s.mul_f(a, b))),
            ("div_f", computed(s, s.div_f(a, b))),
            ("min_f", moved(s, s.min_f(a, b))),
            ("max_f", moved(s, s.max_f(a, b))),
            ("abs_f", moved(s, s.abs_f(a))),
            ("gt_f", vec![s.gt_f(a, b).into()]),
            ("ge_f", vec![s.ge_f(a, b).into()]),
            ("eq_f", vec![s.eq_f(a, b).into()]),
            ("eq_f of itself", vec![s.eq_f(a, a).into()]),
            ("blend_f", moved(s, s.blend_f(*mask, a, b))),
            ("reduce_min_f", vec![s.reduce_min_f(numbers).to_bits().into()]),
            ("reduce_max_f", vec![s.reduce_max_f(numbers).to_bits().into()]),
            ("round_i", integers(s, s.round_i(a))),
            ("floor_i", integers(s, s.floor_i(a))),
            ("bits_of_f", integers(s, s.bits_of_f(a))),
            ("compress_f", packed),
            ("lookup_f", moved(s, s.lookup_f(table_f, index))),
            ("gather_f", moved(s, s.gather_f(*mask, table_f, index, b))),
        ]
    }
}

struct Integers<'a>(&'a Inputs);

impl Kernel for Integers<'_> {
    type Output = Results;

    fn run<S: Simd>(self, s: S) -> Results {
        let Inputs { i, bytes, mask, table_i, index, edges, .. } = self.0;
        let (a, b) = (s.load_i(&i[0]), s.load_i(&i[1]));
        let mut packed = [0; 16];
        s.compress_i(*mask, a, &mut packed);
        let packed = packed[..mask.count_ones() as usize].iter().map(|&v| v as u32 as u64).collect();
        let index = s.load_i(index);
        vec![
            ("splat_i", integers(s, s.splat_i(i[0][0]))),
            ("load_i, store_i", integers(s, a)),
            ("load_u8", integers(s, s.load_u8(bytes))),
            ("f_from_i", computed(s, s.f_from_i(a))),
            ("f_from_bits", moved(s, s.f_from_bits(a))),
            ("add_i", integers(s, s.add_i(a, b))),
            ("sub_i", integers(s, s.sub_i(a, b))),
            ("mul_i", integers(s, s.mul_i(a, b))),
            ("min_i", integers(s, s.min_i(a, b))),
            ("max_i", integers(s, s.max_i(a, b))),
            ("and_i", integers(s, s.and_i(a, b))),
            ("or_i", integers(s, s.or_i(a, b))),
            ("shl_i 0", integers(s, s.shl_i::<0>(a))),
            ("shl_i 8", integers(s, s.shl_i::<8>(a))),
            ("shl_i 31", integers(s, s.shl_i::<31>(a))),
            ("shr_i 0", integers(s, s.shr_i::<0>(a))),
            ("shr_i 8", integers(s, s.shr_i::<8>(a))),
            ("shr_i 31", integers(s, s.shr_i::<31>(a))),
            ("gt_i", vec![s.gt_i(a, b).into()]),
            ("eq_i", vec![s.eq_i(a, b).into()]),
            ("sign_i", vec![s.sign_i(a).into()]),
            ("blend_i", integers(s, s.blend_i(*mask, a, b))),
            ("reduce_min_i", vec![s.reduce_min_i(a) as u32 as u64]),
            ("reduce_max_i", vec![s.reduce_max_i(a) as u32 as u64]),
            ("compress_i", packed),
            ("lookup_i", integers(s, s.lookup_i(table_i, index))),
            ("gather_i", integers(s, s.gather_i(*mask, table_i, index, b))),
            ("coverage_16", vec![s.coverage_16(edges[0], edges[1], edges[2])]),
        ]
    }
}

struct Doubles<'a>(&'a Inputs);

impl Kernel for Doubles<'_> {
    type Output = Results;

    fn run<S: Simd>(self, s: S) -> Results {
        let Inputs { f, i, mask, .. } = self.0;
        let small = s.splat_d(1.0 / f64::from(1 << 28));
        let wide =
            |a: &[f32; 16], b: &[f32; 16]| s.add_d(s.d_from_f(s.load_f(a)), s.mul_d(s.d_from_f(s.load_f(b)), small));
        let (a, b) = (wide(&f[0], &f[2]), wide(&f[1], &f[0]));
        vec![
            ("splat_d", doubles(s, s.splat_d(f64::from(f[0][0]) * 1.1))),
            ("d_from_f", doubles(s, s.d_from_f(s.load_f(&f[0])))),
            ("d_from_i", doubles(s, s.d_from_i(s.load_i(&i[0])))),
            ("add_d", doubles(s, s.add_d(a, b))),
            ("sub_d", doubles(s, s.sub_d(a, b))),
            ("mul_d", doubles(s, s.mul_d(a, b))),
            ("div_d", doubles(s, s.div_d(a, b))),
            ("min_d", doubles(s, s.min_d(a, b))),
            ("max_d", doubles(s, s.max_d(a, b))),
            ("floor_d", doubles(s, s.floor_d(a))),
            ("gt_d", vec![s.gt_d(a, b).into()]),
            ("eq_d", vec![s.eq_d(a, b).into()]),
            ("eq_d of itself", vec![s.eq_d(a, a).into()]),
            ("blend_d", doubles(s, s.blend_d(*mask, a, b))),
            ("f_from_d", computed(s, s.f_from_d(a))),
        ]
    }
}

/// The levels of this CPU; those that it lacks are named, never passed over in silence.
fn available() -> Vec<Level> {
    let (here, absent): (Vec<_>, Vec<_>) = Level::ALL.into_iter().partition(|l| l.is_available());
    for level in absent {
        println!("SIMD level {} absent: not tested", level.name());
    }
    here
}

#[track_caller]
fn same_bits(run: impl Fn(Level, &Inputs) -> Results) {
    let mut r = Random(1);
    let levels = available();
    for round in 0..3000 {
        let inputs = Inputs::new(&mut r);
        let gold = run(Level::Scalar, &inputs);
        for &level in &levels {
            for ((name, gold), (_, got)) in gold.iter().zip(run(level, &inputs)) {
                if let Some(lane) = (0..gold.len()).find(|&l| gold[l] != got[l]) {
                    panic!(
                        "{name} at {}, round {round}, lane {lane}: {:#x}, scalar {:#x}\nfloats {:?}\nintegers {:?}\nmask {:016b}",
                        level.name(),
                        got[lane],
                        gold[lane],
                        inputs.f.map(|f| f[lane]),
                        inputs.i.map(|i| i[lane]),
                        inputs.mask
                    );
                }
            }
        }
    }
}

#[test]
fn floats_have_the_same_bits_at_every_level() {
    same_bits(|level, inputs| level.run(Floats(inputs)));
}

#[test]
fn integers_have_the_same_bits_at_every_level() {
    same_bits(|level, inputs| level.run(Integers(inputs)));
}

#[test]
fn doubles_have_the_same_bits_at_every_level() {
    same_bits(|level, inputs| level.run(Doubles(inputs)));
}

#[test]
fn coverage_of_sixteen_bits_is_the_sign_of_the_wide_sum_while_the_bound_holds() {
    let mut r = Random(2);
    for round in 0..20_000 {
        let mut edge = || {
            let reach = (r.bits() % 4682) as i32;
            let a = if reach == 0 { 0 } else { (r.bits() % (2 * reach as u64 + 1)) as i32 - reach };
            let b = 4681 - a.abs();
            let b = (r.bits() % (2 * b as u64 + 1)) as i32 - b;
            (a as i16, b as i16, r.short())
        };
        let e = [edge(), edge(), edge()];
        let inside =
            |x: i32, y: i32| e.iter().all(|&(a, b, c)| i32::from(c) + i32::from(a) * x + i32::from(b) * y >= 0);
        let gold = (0..64).filter(|&i| inside(i % 8, i / 8)).fold(0u64, |w, i| w | 1 << i);
        struct One([(i16, i16, i16); 3]);
        impl Kernel for One {
            type Output = u64;
            fn run<S: Simd>(self, s: S) -> u64 {
                s.coverage_16(self.0.map(|e| e.0), self.0.map(|e| e.1), self.0.map(|e| e.2))
            }
        }
        for level in Level::ALL.into_iter().filter(|l| l.is_available()) {
            let got = level.run(One(e));
            assert_eq!(got, gold, "round {round} at {}, edges {e:?}: {got:064b}, should be {gold:064b}", level.name());
        }
    }
}

#[test]
fn conversions_round_to_even_and_give_the_least_integer_where_nothing_fits() {
    struct Convert([f32; 16]);
    impl Kernel for Convert {
        type Output = [[i32; 16]; 2];
        fn run<S: Simd>(self, s: S) -> [[i32; 16]; 2] {
            let v = s.load_f(&self.0);
            let mut to = [[0; 16]; 2];
            s.store_i(s.round_i(v), &mut to[0]);
            s.store_i(s.floor_i(v), &mut to[1]);
            to
        }
    }
    let (most, none) = (2_147_483_520, i32::MIN);
    let v = [
        0.5,
        1.5,
        2.5,
        -0.5,
        -1.5,
        -0.0,
        f32::NAN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        2_147_483_648.0,
        -2_147_483_648.0,
        2_147_483_520.0,
        1e-45,
        -1e-45,
        8_388_607.5,
        -8_388_607.5,
    ];
    let round = [0, 2, 2, 0, -2, 0, none, none, none, none, none, most, 0, 0, 8_388_608, -8_388_608];
    let floor = [0, 1, 2, -1, -2, 0, none, none, none, none, none, most, 0, -1, 8_388_607, -8_388_608];
    for level in available() {
        assert_eq!(level.run(Convert(v)), [round, floor], "at {}", level.name());
    }
}

#[test]
fn a_gather_out_of_range_panics_at_every_level() {
    #[derive(Clone, Copy)]
    struct Gather(i32, bool);
    impl Kernel for Gather {
        type Output = ();
        fn run<S: Simd>(self, s: S) {
            let mut index = [0; 16];
            index[5] = self.0;
            let index = s.load_i(&index);
            let mask = if self.1 { 1 << 5 } else { 1 << 4 };
            let _ = s.gather_f(mask, &[1.0; 7], index, s.splat_f(0.0));
            let _ = s.gather_i(mask, &[1; 7], index, s.splat_i(0));
        }
    }
    for level in available() {
        for index in [7, -1, i32::MIN, i32::MAX] {
            level.run(Gather(index, false));
            let caught = std::panic::catch_unwind(|| level.run(Gather(index, true)));
            assert!(caught.is_err(), "index {index} of 7 passed at {}", level.name());
        }
    }
}

#[test]
fn every_level_of_this_cpu_is_tested() {
    let here = available();
    assert!(here.contains(&Level::Scalar));
    assert_eq!(here.last(), Some(&Level::best()));
    #[cfg(target_arch = "x86_64")]
    {
        assert_eq!(here.contains(&Level::Avx2), is_x86_feature_detected!("avx2") && is_x86_feature_detected!("bmi2"));
        let wide = is_x86_feature_detected!("avx512bw") && is_x86_feature_detected!("avx512vl");
        assert_eq!(here.contains(&Level::Avx512), wide && is_x86_feature_detected!("avx512dq"));
    }
    for level in Level::ALL {
        assert_eq!(Level::from_name(level.name()), Some(level));
    }
}

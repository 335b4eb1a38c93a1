//! What `homcull methods` tells of each method: its source, guarantee, parameters, and when to use it.

use super::overlap_parameters::overlap_parameters;

/// What `homcull methods` says of one.
#[derive(Debug, Clone, Copy)]
pub struct MethodDescription {
    /// Its name.
    pub name: &'static str,
    /// Where it is from.
    pub source: &'static str,
    /// What it promises.
    pub guarantee: &'static str,
    /// Parameters with their values, the default first.
    pub parameters: &'static str,
    /// When to use it.
    pub when: &'static str,
}

/// What all hom methods take.
macro_rules! hom_parameters {
    () => {
        concat!(
            "depth=nbz|nbz-block|deb|plane, deb-size=64x64 (with deb), resolution=WxH (the display's), \
             occluders=original|simplified|lod, share=0.1 (with simplified), lod=4 (pixels; approximate), bypass=384, rest=15, pipeline=off|on, \
             lag=1 (3 with pipeline=on), ",
            overlap_parameters!()
        )
    };
}

/// All methods.
pub fn methods() -> &'static [MethodDescription] {
    &[
        MethodDescription {
            name: "vfc",
            source: "view-frustum culling, hierarchical with plane masking",
            guarantee: "conservative",
            parameters: "none",
            when: "the baseline; open scenes need no more",
        },
        MethodDescription {
            name: "detail",
            source: "Moeller; Russin's lecture, detail culling",
            guarantee: "approximate while the view moves; off when it stands still",
            parameters: "pixels=4 (samples of projected area)",
            when: "as a first stage, where many objects cover a few samples",
        },
        MethodDescription {
            name: "hom",
            source: "Zhang 1998, chapters 3 to 7: one pass (2.1.4)",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: concat!(
                "select=distance|nearest|zplane|temporal|baked, bake=FILE, snap=1, fill=on|off, occluder-triangles=25000, z=50, \
                 database=all|static, with static: static-size=0.001, static-locality=off, static-aspect=off, \
                 static-complexity=6250, static-redundancy=0.95; update=once|batches|always, and: ",
                hom_parameters!()
            ),
            when: "near objects hide most of the rest; occluders can be drawn on other threads",
        },
        MethodDescription {
            name: "hom-multipass",
            source: "Zhang 1998, 2.1.4 and figure 2.4",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: "update-triangles=2000, and those of hom-progressive",
            when: "updates are dear",
        },
        MethodDescription {
            name: "hom-progressive",
            source: "Zhang 1998, 2.1.4 and figure 2.3, through the hierarchy",
            guarantee: "conservative with threshold=1 at the display's resolution",
            parameters: hom_parameters!(),
            when: "the first choice where anything is hidden",
        },
        MethodDescription {
            name: "plp",
            source: "Correa, Klosowski and Silva 2002; Klosowski and Silva 2000",
            guarantee: "approximate: what the budget does not reach is missing",
            parameters: "budget=140000 (triangles), heuristic=solidity|layer, cells=octree|bvh, leaf=16000 (triangles of an octree's leaf)",
            when: "a frame may take so long and no longer, and some pixels may be wrong",
        },
        MethodDescription {
            name: "cplp",
            source: "Correa, Klosowski and Silva 2002, with a query for each node",
            guarantee: "conservative",
            parameters: "budget=140000 (triangles of the first guess), heuristic=solidity|layer, leaf=16000",
            when: "now and then, the view that plp has without its wrong pixels",
        },
        MethodDescription {
            name: "portals",
            source: "Luebke and Georges 1995; Russin's lecture, portal culling",
            guarantee: "conservative for cells whose walls have no cracks",
            parameters: "clip=polygon|rectangle, cells=any|given|found (any: those that the scene brings, else found along opaque axis-aligned walls)",
            when: "indoors, where walls are aligned with the axes or the scene brings cells: nothing is drawn for it",
        },
        MethodDescription {
            name: "horizons",
            source: "Downs et al. 2001, in Russin's lecture: occlusion horizons; intervals of azimuth and slope, upright boxes inside what is drawn",
            guarantee: "conservative as sets of points; of closed opaque objects, y up",
            parameters: "none",
            when: "cities of closed buildings, from the street; nothing is drawn to decide",
        },
        MethodDescription {
            name: "hzb",
            source: "Greene, Kass and Miller 1993, in Zhang 1998, 2.2.3.5: the Z-buffer of the final draw, through the hierarchy",
            guarantee: "conservative",
            parameters: "first=none|previous",
            when: "the CPU draws the picture: occluders cost nothing extra",
        },
        MethodDescription {
            name: "stop-and-wait",
            source: "Bittner et al. 2004, 2.3, with occlusion queries in software",
            guarantee: "conservative with pixels=0",
            parameters: "latency=0 (steps) or thread, pixels=0, order=priority|depth",
            when: "to measure chc by",
        },
        MethodDescription {
            name: "chc",
            source: "Bittner et al. 2004: coherent hierarchical culling; spread, idle: Mattausch et al. 2008, CHC++",
            guarantee: "conservative with pixels=0",
            parameters: "latency=0 (steps) or thread, pixels=0, assume-visible=0 (frames) or adaptive, spread=off|on, \
                         order=priority|depth, speculate=off|on, idle=off|on",
            when: "answers come late, as from a GPU or another thread, and views change little",
        },
        MethodDescription {
            name: "pvs",
            source: "Bittner et al. 2004, section 5; Zhang 1998, 7.5: visible sets from a bake",
            guarantee: "approximate: a list is what one point sees; conservative out of reach of all points",
            parameters: "bake=FILE (needed), snap=1, points=1|8",
            when: "the scene does not move and nothing may be tested; every view point was baked",
        },
        MethodDescription {
            name: "ideal",
            source: "Zhang 1998, 8.3.1: the objects of an exact item buffer; Bittner et al. 2004: those of stop-and-wait",
            guarantee: "exact; its set is computed beforehand and not timed",
            parameters: "set=exact|stop-and-wait",
            when: "to see what any method could gain at most",
        },
    ]
}

//! True solutions to sixteen digits, from conformal maps.

#![allow(clippy::excessive_precision)] // They stand with all digits of their source.

/// A problem with what two resolutions in quadruple precision agree on.
pub(crate) struct Reference {
    pub f: &'static str,
    pub energy: f64,
    pub centre: f64,
    /// v in the corners, anticlockwise from the lower right one.
    pub corners: [f64; 4],
    /// Where contact begins and ends, if not everywhere.
    pub contact: Option<[[f64; 2]; 2]>,
}

pub(crate) const REFERENCES: [Reference; 8] = [
    Reference {
        f: "rect(0.25,0.5,0.25,0.5)=2; else=-1",
        energy: -0.016602302753503897,
        centre: -0.068755925311560558,
        corners: [0.0, 0.038843550387098673, 0.0, 0.0],
        contact: Some([[0.194250479506949330, 0.5], [0.5, 0.194250479506949330]]),
    },
    Reference {
        f: "rect(-0.25,0.25,-0.25,0.25)=1.5; else=-1",
        energy: -0.005375455092882997,
        centre: 0.039544041992167949,
        corners: [0.0; 4],
        contact: None,
    },
    Reference {
        f: "quadrant(ll)=3; else=-1.1",
        energy: -0.095051720753350786,
        centre: 0.119928025738472246,
        corners: [0.040559926457179154, 0.0, 0.040559926457179154, 0.439419001292514409],
        contact: Some([[0.5, 0.094404156233095124], [0.094404156233095124, 0.5]]),
    },
    Reference {
        f: "quadrant(ll)=3; else=-1.002",
        energy: -0.100744189417478743,
        centre: 0.173341417900582503,
        corners: [0.099550492710656832, 0.0, 0.099550492710656832, 0.496926392867702065],
        contact: Some([[0.5, 0.445188172822940070], [0.445188172822940070, 0.5]]),
    },
    Reference {
        f: "quadrant(ll)=-6; else=1.998",
        energy: -0.402452348899040672,
        centre: 0.643250065051246157,
        corners: [0.790473197646332111, 0.995570979144065707, 0.790473197646332111, 0.0],
        contact: Some([[-0.5, -0.477641454445133592], [-0.477641454445133592, -0.5]]),
    },
    Reference {
        f: "disc(0,0,0.25)=2; else=-1",
        energy: -0.006911812402917770,
        centre: 0.045288829446766785,
        corners: [0.0; 4],
        contact: None,
    },
    Reference {
        f: "disc(0.1,-0.2,0.3)=3; disc(-0.1,0.1,0.25)=-4; else=-1",
        energy: -0.060527282639588421,
        centre: -0.063103573848361069,
        corners: [0.104522610652802365, 0.0, 0.0, 0.0],
        contact: Some([[0.5, 0.150657255623229887], [-0.387437294326123048, -0.5]]),
    },
    Reference {
        f: "disc(0.5,0.5,0.3)=4; else=-1",
        energy: -0.025624898159882615,
        centre: -0.054595125204661644,
        corners: [0.0, 0.150972413969915567, 0.0, 0.0],
        contact: Some([[0.006127028704528844, 0.5], [0.5, 0.006127028704528844]]),
    },
];

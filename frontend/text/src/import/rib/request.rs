//! The requests of RIB, and what each of them is to a reader of blobs.

/// What a request means here.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum Request {
    WorldBegin,
    Begin(RibBlock),
    End(RibBlock),
    Translate,
    Scale,
    Rotate,
    ConcatTransform,
    Transform,
    Identity,
    Color,
    Declare,
    Blobby,
    MotionBegin,
    MotionEnd,
    /// It has no effect on a field: camera, lights, shaders, options, names.
    Look,
    /// A shape of another kind, which is left out.
    Shape,
    ObjectBegin,
    ObjectEnd,
    ObjectInstance,
    /// It changes the space of what follows in a way that is not read.
    Unusable,
    /// What it would bring is left out: what it does.
    LeftOut(&'static str),
}

/// What keeps a state, to bring it back at its end.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(super) enum RibBlock {
    Transform,
    Attribute,
    Frame,
    World,
    Object,
}

impl RibBlock {
    /// As its requests begin.
    pub(super) const fn name(self) -> &'static str {
        match self {
            Self::Transform => "Transform",
            Self::Attribute => "Attribute",
            Self::Frame => "Frame",
            Self::World => "World",
            Self::Object => "Object",
        }
    }
}

const REQUESTS: &[(&str, Request)] = &[
    ("WorldBegin", Request::WorldBegin),
    ("WorldEnd", Request::End(RibBlock::World)),
    ("TransformBegin", Request::Begin(RibBlock::Transform)),
    ("TransformEnd", Request::End(RibBlock::Transform)),
    ("AttributeBegin", Request::Begin(RibBlock::Attribute)),
    ("AttributeEnd", Request::End(RibBlock::Attribute)),
    ("FrameBegin", Request::Begin(RibBlock::Frame)),
    ("FrameEnd", Request::End(RibBlock::Frame)),
    ("Translate", Request::Translate),
    ("Scale", Request::Scale),
    ("Rotate", Request::Rotate),
    ("ConcatTransform", Request::ConcatTransform),
    ("Transform", Request::Transform),
    ("Identity", Request::Identity),
    ("Color", Request::Color),
    ("Declare", Request::Declare),
    ("Blobby", Request::Blobby),
    ("MotionBegin", Request::MotionBegin),
    ("MotionEnd", Request::MotionEnd),
    ("ObjectBegin", Request::ObjectBegin),
    ("ObjectEnd", Request::ObjectEnd),
    ("ObjectInstance", Request::ObjectInstance),
    ("Skew", Request::Unusable),
    ("Deformation", Request::Unusable),
    ("CoordSysTransform", Request::Unusable),
    ("Perspective", Request::Unusable),
    ("ReadArchive", Request::LeftOut("reads another file")),
    ("Procedural", Request::LeftOut("asks a program for shapes")),
    ("SolidBegin", Request::LeftOut("is a set operation over whole shapes, which become a union here")),
];

/// Requests that have no effect on a field.
const LOOKS: &[&str] = &[
    "ArchiveRecord",
    "Basis",
    "AreaLightSource",
    "Atmosphere",
    "Attribute",
    "Bound",
    "Clipping",
    "ClippingPlane",
    "ColorSamples",
    "CoordinateSystem",
    "CropWindow",
    "DepthOfField",
    "Detail",
    "DetailRange",
    "Displacement",
    "Display",
    "DisplayChannel",
    "Else",
    "ElseIf",
    "ErrorHandler",
    "Exposure",
    "Exterior",
    "Format",
    "FrameAspectRatio",
    "GeometricApproximation",
    "GeometricRepresentation",
    "Hider",
    "IfBegin",
    "IfEnd",
    "Illuminate",
    "Imager",
    "Interior",
    "LightSource",
    "MakeBrickMap",
    "MakeBump",
    "MakeCubeFaceEnvironment",
    "MakeLatLongEnvironment",
    "MakeOcclusion",
    "MakeShadow",
    "MakeTexture",
    "Matte",
    "Opacity",
    "Option",
    "Orientation",
    "PixelFilter",
    "PixelSamples",
    "PixelVariance",
    "Projection",
    "Quantize",
    "RelativeDetail",
    "Resource",
    "ResourceBegin",
    "ResourceEnd",
    "ReverseOrientation",
    "ScopedCoordinateSystem",
    "ScreenWindow",
    "Shader",
    "ShadingInterpolation",
    "ShadingRate",
    "Shutter",
    "Sides",
    "SolidEnd",
    "Surface",
    "TextureCoordinates",
    "TrimCurve",
    "version",
];

/// Shapes that are no blobs.
const SHAPES: &[&str] = &[
    "Cone",
    "Curves",
    "Cylinder",
    "Disk",
    "GeneralPolygon",
    "Geometry",
    "Hyperboloid",
    "NuPatch",
    "Paraboloid",
    "Patch",
    "PatchMesh",
    "Points",
    "PointsGeneralPolygons",
    "PointsPolygons",
    "Polygon",
    "Sphere",
    "SubdivisionMesh",
    "Torus",
];

/// What a word means; `None` if there is no such request.
pub(super) fn find(word: &str) -> Option<Request> {
    let acts = REQUESTS.iter().find(|(name, _)| *name == word).map(|&(_, request)| request);
    let looks = || LOOKS.contains(&word).then_some(Request::Look);
    let shapes = || SHAPES.contains(&word).then_some(Request::Shape);
    acts.or_else(looks).or_else(shapes)
}

/// All requests that are known, for hints.
pub(super) fn names() -> impl Iterator<Item = &'static str> {
    REQUESTS.iter().map(|(name, _)| *name).chain(LOOKS.iter().copied()).chain(SHAPES.iter().copied())
}

"""The design that a result of a moving pair holds; fields are its keys, with their units."""

from typing import Annotated

from gearopt.frozen import dataclass
from gearopt.optimise.typed import Shown

Columns = tuple[float, ...]
Rows = tuple[Columns, ...]
Gaps = tuple[float | None, ...]
TRANSMISSION = "dynamic transmission error"
OUT_OF_MESH = "Teeth leave mesh"  # how the first of the warnings begins where they do


@dataclass(frozen=True, kw_only=True)
class Equilibrium:
    """The pair at rest under its load, and its modes there at the mean stiffness."""

    normal_load_N: Annotated[float, Shown("normal load")]
    mean_stiffness_N_per_mm: Annotated[float, Shown("mean mesh stiffness")]
    mesh_mass_kg: Annotated[float, Shown("reduced mass of the mesh")]
    deformation_mm: Annotated[float, Shown("deformation δ, negative in compression", unit="um")]
    centre_distance_mm: Annotated[float, Shown("centre distance")]
    centre_distance_growth_mm: Annotated[float, Shown("growth of the centre distance")]
    pressure_angle_deg: Annotated[float, Shown("pressure angle")]
    bearing_force_N: Annotated[float, Shown("bearing force")]
    frequencies_Hz: Columns
    mesh_shares: Columns


@dataclass(frozen=True, kw_only=True)
class ToothLoad:
    """Load on the teeth in a motion; minimum below zero on the coast flanks.

    dynamic_factor: the largest load on either flank over the normal load.
    """

    maximum_N: Annotated[float, Shown("tooth load, maximum")]
    minimum_N: Annotated[float, Shown("tooth load, minimum")]
    rms_N: Annotated[float, Shown("tooth load, RMS")]
    dynamic_factor: Annotated[float, Shown("dynamic factor: maximum over normal load")]


@dataclass(frozen=True, kw_only=True)
class DynamicError:
    """Transmission error in a motion: that of the unloaded teeth and the deformation together.

    rms: about its mean. values: at the times of the motion.
    """

    rms_mm: Annotated[float, Shown(f"{TRANSMISSION}, RMS about the mean", unit="um")]
    peak_to_peak_mm: Annotated[float, Shown(f"{TRANSMISSION}, peak to peak", unit="um")]
    highest_mm: Annotated[float, Shown(f"{TRANSMISSION}, maximum", unit="um")]
    values_mm: Columns


@dataclass(frozen=True, kw_only=True)
class DynamicErrors:
    """The same at speeds, None where a motion grows for ever."""

    rms_mm: Gaps
    peak_to_peak_mm: Gaps
    highest_mm: Gaps


@dataclass(frozen=True, kw_only=True)
class StandardFactors:
    """K_v of ISO 6336-1, method B, and of AGMA 2001-D04, None beyond the curve.

    own: at the pair's own speed; iso, agma: at those of [speeds]. missing: why one is not told.
    """

    own_iso: float | None = None
    own_agma: float | None = None
    iso: Gaps = ()
    agma: Gaps = ()
    missing: str = ""


@dataclass(frozen=True, kw_only=True)
class Response:
    """A motion in time, about as many outputs as a plot shows.

    deformation: negative where teeth press. axes: x and y of pinion and wheel; none on fixed axes.
    error: estimated, of the deformation, relative to its largest value. frequency, amplitude: of
    the deformation's spectrum over the second half. jammed: when both flanks are first pressed at
    once, as the axes came together; None: never. steady: until when roundings stay below the error
    asked; None: to the end. tooth_load: of the second half; load: on the teeth at every time.
    transmission_error: of the second half; None where unloaded teeth have none.
    """

    method: str
    error: float
    error_asked: float
    met: bool
    steps: int
    separations: int
    rms_mm: float
    peak_to_peak_mm: float
    highest_mm: float
    time_ms: Columns
    deformation_mm: Columns
    axes_mm: Rows
    frequency_Hz: Columns
    amplitude_mm: Columns
    jammed_ms: float | None = None
    steady_ms: float | None = None
    tooth_load: ToothLoad | None = None
    load_N: Columns = ()
    transmission_error: DynamicError | None = None


@dataclass(frozen=True, kw_only=True)
class Tongue:
    """Where a harmonic of the mesh excites two modes (or one twice), to first order."""

    modes: tuple[int, int]
    harmonic: int
    frequency_Hz: float
    half_width_percent: float
    damping_percent: float


@dataclass(frozen=True, kw_only=True)
class Stability:
    """Largest Floquet multipliers over mesh frequency and depth of the wave.

    growth (depths, frequencies). here: at the pair's own frequency and depth; None where it has
    none. bands: unstable mesh frequencies at its own depth. limited_rms: of the motion at its own
    frequency where contact is unstable there and teeth that part limit it; else None. error: of a
    multiplier, estimated, the largest of the map.
    """

    frequency_Hz: Columns
    depth: Columns
    growth: Rows
    unstable_percent: float
    own_depth: float
    own_frequency_Hz: float
    here: float | None
    bands_Hz: Rows
    tongues: tuple[Tongue, ...]
    limited_rms_mm: float | None = None
    error: float | None = None


@dataclass(frozen=True, kw_only=True)
class Speeds:
    """Motions over speed, None where one grows for ever: rising, and falling where teeth may part.

    falling: () where they may not, or the run was stopped. teeth_part: whether they may; else the
    mesh also pulls. repeats: after how many periods of the
    mesh; 0: not within eight. growth: largest multiplier of
    teeth in contact. jammed: speeds at which both flanks are pressed at once, as the axes come
    together. harmonics (orders, speeds): amplitudes. loads (3, speeds): maximum, minimum and RMS of
    the tooth load. errors: estimated, of the deformation relative to its largest value; of motions
    that do not repeat how much their RMS varies. transmission_error: None where unloaded teeth have
    none.
    """

    teeth_part: bool
    speed_rpm: Columns
    rms_mm: Gaps
    peak_to_peak_mm: Gaps
    highest_mm: Gaps
    repeats: tuple[int, ...]
    falling_rms_mm: Gaps
    falling_peak_to_peak_mm: Gaps
    falling_highest_mm: Gaps
    falling_repeats: tuple[int, ...]
    growth: Columns
    jammed_rpm: Columns
    harmonics_mm: tuple[Gaps, ...]
    loads_N: tuple[Gaps, ...] = ()
    falling_loads_N: tuple[Gaps, ...] = ()
    dynamic_factor: Gaps = ()
    falling_dynamic_factor: Gaps = ()
    errors: Gaps = ()
    falling_errors: Gaps = ()
    transmission_error: DynamicErrors | None = None
    falling_transmission_error: DynamicErrors | None = None


@dataclass(frozen=True, kw_only=True)
class Chosen:
    """The design of least vibration, its limits' numbers, and its response over dense speeds.

    rounds: speeds, harmonics, objective and dense maximum [um] of every round of the exchange.
    parting_speeds: of the dense grid, at which teeth part. longest_repeat: mesh periods after which
    all motions repeat; 0: one does not soon.
    """

    bearing_stiffness_N_per_mm: Annotated[float, Shown("bearing stiffness")]
    contact_ratio: Annotated[float, Shown("contact ratio")]
    ramp: Annotated[float, Shown("ramp of the stiffness over the mesh period")]
    face_width_mm: Annotated[float, Shown("face width")]
    rim: Annotated[float, Shown("rim factor")]
    mass_kg: Annotated[float, Shown("mass of both gears")]
    displacement_mm: Annotated[float, Shown("displacement of an axis at rest", unit="um")]
    dense_maximum_mm: Annotated[
        float, Shown("largest RMS of the deformation about its mean, over all speeds", unit="um")
    ]
    highest_mm: Annotated[float, Shown("highest deformation δ, negative in compression", unit="um")]
    largest_multiplier: Annotated[float | None, Shown("largest Floquet multiplier of all speeds")]
    harmonics: int
    speed_rpm: Columns
    rounds: tuple[tuple[float, float, float, float], ...]
    dense_rpm: Columns
    dense_mm: Columns
    before_mm: Gaps
    parting_speeds: int
    longest_repeat: int


@dataclass(frozen=True, kw_only=True)
class DynamicsDesign:
    """A pair on moving axes."""

    kinematics: str
    axes: str
    mesh_frequency_Hz: float
    equilibrium: Equilibrium
    response: Response | None = None
    stability: Stability | None = None
    speeds: Speeds | None = None
    standard: StandardFactors | None = None
    chosen: Chosen | None = None
    warnings: tuple[str, ...] = ()

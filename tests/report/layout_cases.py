"""Results with a layout or a packing, as the solvers give them, from worked cases."""

import math

import gearopt
from gearopt.formulations.drive.design import describe
from gearopt.formulations.drive.toothing import Toothing
from gearopt.formulations.drive.train import FaceWidth, Stage, Train
from gearopt.formulations.strength.laws.k_factor import K_FACTOR
from gearopt.optimise.typed import untyped

HELIX = 25.0
WALL, AXIAL, CLEARANCE = 10.0, 10.0, 2.0
THREE_STAGE = ((1.5, 27, 229, 26.8), (3.0, 26, 105, 47.8), (4.0, 27, 87, 95.3))  # m_n, z1, z2, b
THREE_STAGE_RADII = (8.0, 15.0, 22.5, 35.0)
FULL_SPAN = (  # proven axes (y, z) of the three-stage drive: box 411.98 x 873.29 x 209.9 mm
    (0.0, 0.0),
    (152.38212029690303, 147.1716751778643),
    (176.57045627744967, 362.63195317468956),
    (157.3647206145689, 613.4679312542758),
)
PARTIAL_SPAN = (  # the same drive, shafts that end beside their gears: 411.98 x 643.61 x 209.9 mm
    (0.0, 0.0),
    (55.13437248219758, -204.5483158860833),
    (37.81212091835186, 11.572360109379645),
    (57.01785658123265, -239.26361797020655),
)
ELEVATOR = ((2.0, 21, 115, 27.805), (3.0, 23, 91, 57.1))
ELEVATOR_RADII = (10.0, 17.5, 30.0)
ELEVATOR_AXES = (  # 327.22 x 489.55 x 114.905 mm
    (0.0, 0.0),
    (113.48170597914526, 98.1821013715514),
    (88.75908072145182, 285.2329972594317),
)


def gears(rows):
    """Gears of all stages, slab after slab from x = 0."""
    found, x = [], AXIAL
    for k, (module, pinion, wheel, width) in enumerate(rows, 1):
        for member, teeth, shaft in (("pinion", pinion, k), ("wheel", wheel, k + 1)):
            d = module * teeth / math.cos(math.radians(HELIX))
            found.append(
                {
                    "name": f"{member} {k}",
                    "stage": k,
                    "member": member,
                    "shaft": shaft,
                    "teeth": teeth,
                    "normal_module_mm": module,
                    "reference_diameter_mm": d,
                    "tip_diameter_mm": d + 2.0 * module,
                    "root_diameter_mm": d - 2.5 * module,
                    "from_mm": x,
                    "to_mm": x + width,
                    "helix_angle_deg": HELIX,
                }
            )
        x += width + AXIAL
    return found, x


def gaps(found, shafts):
    """Every gear against every shaft that it passes and does not sit on or mesh with."""
    places = {s["shaft"]: (s["y_mm"], s["z_mm"]) for s in shafts}
    rows = []
    for gear in found:
        for shaft in shafts:
            meshing = (gear["stage"], gear["stage"] + 1)
            apart = shaft["from_mm"] >= gear["to_mm"] or shaft["to_mm"] <= gear["from_mm"]
            if shaft["shaft"] in meshing or apart:
                continue
            between = math.dist(places[gear["shaft"]], places[shaft["shaft"]])
            gap = between - gear["tip_diameter_mm"] / 2 - shaft["diameter_mm"] / 2
            names = [gear["name"], f"shaft {shaft['shaft']}"]
            sizes = {"gap_mm": gap, "needed_mm": CLEARANCE, "axes_mm": between}
            rows.append({"between": names} | sizes)
    return sorted(rows, key=lambda row: row["gap_mm"])


def layout(rows, axes, radii, partial=False, **more):
    found, length = gears(rows)
    shafts, bearings, reach = [], [], dict.fromkeys(range(1, len(axes) + 1), 0.0)
    for k, ((y, z), r) in enumerate(zip(axes, radii, strict=True), 1):
        on = [g for g in found if g["shaft"] == k]
        start = min(g["from_mm"] for g in on) - AXIAL / 2 if partial and k > 1 else 0.0
        end = max(g["to_mm"] for g in on) + AXIAL / 2 if partial and k < len(axes) else length
        place = {"y_mm": y, "z_mm": z, "diameter_mm": 2 * r, "from_mm": start, "to_mm": end}
        shafts.append({"shaft": k} | place)
        reach[k] = max(g["tip_diameter_mm"] / 2 for g in on)
        for a, b in ((start, start + AXIAL / 2), (end - AXIAL / 2, end)) if partial else ():
            bearings.append({"shaft": k, "diameter_mm": 4 * r, "from_mm": a, "to_mm": b})
    pairs = [(s["y_mm"], s["z_mm"], reach[s["shaft"]] + WALL) for s in shafts]
    left, right = min(y - r for y, _, r in pairs), max(y + r for y, _, r in pairs)
    bottom, top = min(z - r for _, z, r in pairs), max(z + r for _, z, r in pairs)
    width, height = right - left, top - bottom
    return {
        "box": {
            "width_mm": width,
            "height_mm": height,
            "length_mm": length,
            "left_mm": left,
            "bottom_mm": bottom,
            "volume_mm3": width * height * length,
            "plan_area_mm2": width * length,
            "face_area_mm2": width * height,
        },
        "shafts": shafts,
        "gears": found,
        "bearings": bearings,
        "link_angles_deg": [],
        "obstacles": [],
        "motor": None,
        "split": [],
        "slabs": [[k] for k in range(1, len(rows) + 1)],
        "clearances": {
            "gear_to_gear_mm": CLEARANCE,
            "gear_to_shaft_mm": CLEARANCE,
            "wall_mm": WALL,
            "axial_mm": AXIAL,
        },
        "gaps": gaps(found, shafts),
    } | more


PROGRESS = [
    {"seconds": 0.0004, "evaluations": 1, "best": None, "bound": 41.2e6},
    {"seconds": 0.002, "evaluations": 40, "best": 98.3e6, "bound": 55.1e6},
    {"seconds": 0.011, "evaluations": 700, "best": 76.0e6, "bound": 70.2e6},
    {"seconds": 0.08, "evaluations": 6503, "best": 75516512.0, "bound": 75508960.0},
]


def drive(rows):
    """The design of a drive of these stages."""
    own = Toothing(math.radians(HELIX))
    stages = (Stage((1.0, 1.0), FaceWidth(0, None), (), (1, None), toothings=(own,)),) * len(rows)
    train = Train(5e4, 1, 0, stages, law=K_FACTOR, speed=150.0)
    return untyped(describe(train, tuple(train.pair(k, *row) for k, row in enumerate(rows))))


def result(made, rows, **more):
    """The result of a drive that is laid out."""
    volume = made["box"]["volume_mm3"]
    bound = (1.0 - 1e-4) * volume
    told = {
        "name": "drive",
        "scene": "drive",
        "status": "optimal",
        "method": "exact",
        "objective": {"name": "box_volume", "value": volume, "unit": "mm3"},
        "bound": bound,
        "gap": 1e-4,
        "design": drive(rows) | {"layout": made},
        "limits": {"gear_to_shaft[1]": 1.0, "wall": 0.93},
        "report": {"progress": PROGRESS, "notes": ["Angles of the shafts are free."]},
        "evaluations": 6503,
        "seconds": 0.08,
    }
    return gearopt.Result(**told | more)


def three_stage(**more):
    """The proven box of the three-stage drive with shafts from wall to wall."""
    made = layout(THREE_STAGE, FULL_SPAN, THREE_STAGE_RADII)
    return result(made, THREE_STAGE, **more)


def partial_span(**more):
    """The same drive with shafts and bearings that end beside their gears."""
    return result(
        layout(THREE_STAGE, PARTIAL_SPAN, THREE_STAGE_RADII, partial=True), THREE_STAGE, **more
    )


def elevator(**more):
    """The elevator drive with a motor, a keep-out and a split line."""
    obstacle = {"name": "rope sheave", "left_mm": 150.0, "right_mm": 250.0, "bottom_mm": -38.0}
    obstacle |= {"top_mm": 40.0, "from_mm": 0.0, "to_mm": 60.0}
    made = layout(
        ELEVATOR,
        ELEVATOR_AXES,
        ELEVATOR_RADII,
        obstacles=[obstacle],
        motor={"diameter_mm": 200.0},
        split=[2],
    )
    return result(made, ELEVATOR, **more)


def boxed_in(**more):
    """The elevator drive between far keep-outs, with bearings and a motor of unknown length."""
    sides = {"left_mm": -1000.0, "right_mm": 1000.0, "from_mm": -11.5, "to_mm": 126.4}
    obstacles = [
        {"name": "floor", "bottom_mm": -1000.0, "top_mm": -60.0} | sides,
        {"name": "step", "bottom_mm": -60.0, "top_mm": 20.0} | sides | {"left_mm": 300.0},
        {"name": "far wall", "bottom_mm": 2000.0, "top_mm": 3000.0} | sides,
    ]
    obstacles[1]["to_mm"] = 60.0
    motor = {"diameter_mm": 100.0}
    made = layout(ELEVATOR, ELEVATOR_AXES, ELEVATOR_RADII, True, obstacles=obstacles, motor=motor)
    (y1, z1), (y2, z2), (y3, z3) = ELEVATOR_AXES
    wheel_1, wheel_2 = (g["tip_diameter_mm"] / 2 for g in made["gears"][1::2])
    more_gaps = [
        (["motor", "shaft 3"], math.hypot(y3, z3) - 50.0 - ELEVATOR_RADII[2]),
        (["shaft 3 with its gears", "floor"], z3 + 60.0 - wheel_2),
        (["shaft 2 with its gears", "step"], math.hypot(300.0 - y2, z2 - 20.0) - wheel_1),
        (["bearing of shaft 1", "wheel 1"], math.hypot(y2, z2) - 20.0 - wheel_1),
    ]
    sizes = {"needed_mm": 2.0, "axes_mm": 100.0}
    found = [{"between": b, "gap_mm": gap} | sizes for b, gap in more_gaps]
    made["gaps"] = sorted(made["gaps"] + found, key=lambda row: row["gap_mm"])
    return result(made, ELEVATOR, **more)


def cylinder(name, x, y, diameter, layer=1, fixed=False):
    place = {"name": name, "x_mm": x, "y_mm": y, "diameter_mm": diameter, "height_mm": 10.0}
    ends = {"layer": layer, "from_mm": 10.0 * (layer - 1), "to_mm": 10.0 * layer}
    return place | ends | {"fixed": fixed}


def packing(**more):
    """Three large and three small cylinders in two layers of a rectangle."""
    cylinders = [
        cylinder("large 1", 10.0, 10.0, 20.0, fixed=True),
        cylinder("large 2", 30.0, 10.0, 20.0),
        cylinder("large 3", 10.0, 10.0, 20.0, layer=2),
        cylinder("small 1", 25.0, 5.0, 10.0, layer=2),
        cylinder("small 2", 25.0, 15.0, 10.0, layer=2),
        cylinder("small 3", 35.0, 10.0, 10.0, layer=2),
    ]
    container = {"shape": "rectangle", "width_mm": 40.0, "depth_mm": 20.0, "height_mm": 20.0}
    container |= {"area_mm2": 800.0, "volume_mm3": 16000.0, "left_mm": 0.0, "front_mm": 0.0}
    layers = [{"layer": k, "from_mm": 10.0 * (k - 1), "to_mm": 10.0 * k} for k in (1, 2)]
    told = {
        "name": "packing",
        "scene": "packing",
        "status": "feasible",
        "method": "annealing",
        "objective": {"name": "volume", "value": 16000.0, "unit": "mm3"},
        "design": {"container": container, "layers": layers, "cylinders": cylinders},
        "report": {},
    }
    return gearopt.Result(**told | more)


def round_packing(**more):
    """Seven equal cylinders in a circle."""
    ring = [(15.0 + 10.0 * math.cos(k * math.pi / 3), k) for k in range(6)]
    cylinders = [cylinder("core", 15.0, 15.0, 10.0)]
    cylinders += [
        cylinder(f"rim {k + 1}", x, 15.0 + 10.0 * math.sin(k * math.pi / 3), 10.0) for x, k in ring
    ]
    container = {"shape": "circle", "diameter_mm": 30.0, "height_mm": 10.0}
    container |= {"area_mm2": 225.0 * math.pi, "volume_mm3": 2250.0 * math.pi}
    container |= {"left_mm": 0.0, "front_mm": 0.0}
    design = {"container": container, "cylinders": cylinders}
    design["layers"] = [{"layer": 1, "from_mm": 0.0, "to_mm": 10.0}]
    return packing(design=design, **more)

"""STEP files of the corpus (AP214): solids of flat faces, colours, units, parts that stand in an assembly."""

import numpy as np

from tests.corpus.solids import Solid

UNITS = {
    "mm": ["( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"],
    "m": ["( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT($,.METRE.) )"],
    "in": [
        "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )",
        "DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.)",
        "LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),{0})",
        "( CONVERSION_BASED_UNIT('INCH',{2}) LENGTH_UNIT() NAMED_UNIT({1}) )",
    ],
}
"""Entities of a unit of length, the last of which is the unit."""
IN_MM = {"mm": 1.0, "m": 1000.0, "in": 25.4}


class Step:
    """A file in the making."""

    def __init__(self, unit: str = "mm") -> None:
        self.lines: list[str] = []
        self.scale = 1 / IN_MM[unit]
        self.application = self.add("APPLICATION_CONTEXT('automotive design')")
        self.add(
            f"APPLICATION_PROTOCOL_DEFINITION('international standard','automotive_design',2000,{self.application})"
        )
        made: list[str] = []
        for entity in UNITS[unit]:
            made.append(self.add(entity.format(*made)))
        angle = self.add("( NAMED_UNIT(*) PLANE_ANGLE_UNIT() SI_UNIT($,.RADIAN.) )")
        solid_angle = self.add("( NAMED_UNIT(*) SI_UNIT($,.STERADIAN.) SOLID_ANGLE_UNIT() )")
        accuracy = self.add(
            f"UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(1.E-07),{made[-1]},'distance_accuracy_value','')"
        )
        self.context = self.add(
            f"( GEOMETRIC_REPRESENTATION_CONTEXT(3) GLOBAL_UNCERTAINTY_ASSIGNED_CONTEXT(({accuracy})) "
            f"GLOBAL_UNIT_ASSIGNED_CONTEXT(({made[-1]},{angle},{solid_angle})) REPRESENTATION_CONTEXT('','') )"
        )
        self.origin = self.placement((0, 0, 0))

    def add(self, entity: str) -> str:
        """Reference to a new entity."""
        self.lines.append(f"#{len(self.lines) + 1} = {entity};")
        return f"#{len(self.lines)}"

    def point(self, at) -> str:
        """Reference to a point [mm]."""
        return self.add(f"CARTESIAN_POINT('',({_numbers(np.asarray(at, float) * self.scale)}))")

    def direction(self, along) -> str:
        """Reference to a unit vector."""
        return self.add(f"DIRECTION('',({_numbers(np.asarray(along, float) / np.linalg.norm(along))}))")

    def placement(self, at, z=(0, 0, 1), x=(1, 0, 0)) -> str:
        """Reference to a place [mm]."""
        return self.add(f"AXIS2_PLACEMENT_3D('',{self.point(at)},{self.direction(z)},{self.direction(x)})")

    def solid(self, solid: Solid) -> tuple[str, list[str]]:
        """References to a solid and to its faces."""
        vertices = [self.add(f"VERTEX_POINT('',{self.point(point)})") for point in solid.points]
        edges: dict[tuple[int, int], str] = {}
        faces = [self._face(solid, polygon, vertices, edges) for polygon in solid.polygons]
        shell = self.add(f"CLOSED_SHELL('',({','.join(faces)}))")
        return self.add(f"MANIFOLD_SOLID_BREP('',{shell})"), faces

    def _face(self, solid: Solid, polygon: tuple[int, ...], vertices: list[str], edges: dict) -> str:
        oriented = []
        for a, b in zip(polygon, (*polygon[1:], polygon[0]), strict=True):
            ends = (min(a, b), max(a, b))
            if ends not in edges:
                along = solid.points[ends[1]] - solid.points[ends[0]]
                vector = self.add(f"VECTOR('',{self.direction(along)},1.)")
                line = self.add(f"LINE('',{self.point(solid.points[ends[0]])},{vector})")
                edges[ends] = self.add(f"EDGE_CURVE('',{vertices[ends[0]]},{vertices[ends[1]]},{line},.T.)")
            oriented.append(self.add(f"ORIENTED_EDGE('',*,*,{edges[ends]},{'.T.' if a < b else '.F.'})"))
        loop = self.add(f"EDGE_LOOP('',({','.join(oriented)}))")
        bound = self.add(f"FACE_OUTER_BOUND('',{loop},.T.)")
        corners = solid.points[list(polygon)]
        normal = np.cross(corners, np.roll(corners, -1, axis=0)).sum(axis=0)
        plane = self.add(f"PLANE('',{self.placement(corners[0], normal, corners[1] - corners[0])})")
        return self.add(f"ADVANCED_FACE('',({bound}),{plane},.T.)")

    def product(self, name: str, shape: str, items: list[str]) -> tuple[str, str]:
        """References to a product's definition and to its representation, of the kind `shape`."""
        context = self.add(f"PRODUCT_CONTEXT('',{self.application},'mechanical')")
        product = self.add(f"PRODUCT('{name}','{name}','',({context}))")
        formation = self.add(f"PRODUCT_DEFINITION_FORMATION('','',{product})")
        design = self.add(f"PRODUCT_DEFINITION_CONTEXT('part definition',{self.application},'design')")
        definition = self.add(f"PRODUCT_DEFINITION('design','',{formation},{design})")
        of_shape = self.add(f"PRODUCT_DEFINITION_SHAPE('','',{definition})")
        representation = self.add(f"{shape}('',({','.join([self.origin, *items])}),{self.context})")
        self.add(f"SHAPE_DEFINITION_REPRESENTATION({of_shape},{representation})")
        return definition, representation

    def part(self, name: str, *solids: str) -> tuple[str, str]:
        """A product of solids."""
        return self.product(name, "ADVANCED_BREP_SHAPE_REPRESENTATION", list(solids))

    def assembly(self, name: str, instances: list[tuple[str, tuple[str, str], str]]) -> tuple[str, str]:
        """A product of products: name, product and place of each instance."""
        places = [place for _, _, place in instances]
        definition, representation = self.product(name, "SHAPE_REPRESENTATION", places)
        for number, (instance, (child, child_shape), place) in enumerate(instances, start=1):
            transform = self.add(f"ITEM_DEFINED_TRANSFORMATION('','',{self.origin},{place})")
            relation = self.add(
                f"( REPRESENTATION_RELATIONSHIP('','',{child_shape},{representation}) "
                f"REPRESENTATION_RELATIONSHIP_WITH_TRANSFORMATION({transform}) SHAPE_REPRESENTATION_RELATIONSHIP() )"
            )
            usage = self.add(f"NEXT_ASSEMBLY_USAGE_OCCURRENCE('{number}','{instance}','',{definition},{child},$)")
            placed = self.add(f"PRODUCT_DEFINITION_SHAPE('Placement','',{usage})")
            self.add(f"CONTEXT_DEPENDENT_SHAPE_REPRESENTATION({relation},{placed})")
        return definition, representation

    def colour(self, items: list[tuple[str, tuple[float, float, float]]]) -> None:
        """Colour solids or faces."""
        styled = []
        for item, (red, green, blue) in items:
            colour = self.add(f"COLOUR_RGB('',{red:.2f},{green:.2f},{blue:.2f})")
            filling = self.add(f"FILL_AREA_STYLE_COLOUR('',{colour})")
            style = self.add(f"FILL_AREA_STYLE('',({filling}))")
            side = self.add(f"SURFACE_SIDE_STYLE('',({self.add(f'SURFACE_STYLE_FILL_AREA({style})')}))")
            style = self.add(f"PRESENTATION_STYLE_ASSIGNMENT(({self.add(f'SURFACE_STYLE_USAGE(.BOTH.,{side})')}))")
            styled.append(self.add(f"STYLED_ITEM('color',({style}),{item})"))
        self.add(f"MECHANICAL_DESIGN_GEOMETRIC_PRESENTATION_REPRESENTATION('',({','.join(styled)}),{self.context})")

    def text(self) -> bytes:
        """The file."""
        header = (
            "ISO-10303-21;\nHEADER;\nFILE_DESCRIPTION((''),'2;1');\n"
            "FILE_NAME('','2026-01-01T00:00:00',(''),(''),'','','');\n"
            "FILE_SCHEMA(('AUTOMOTIVE_DESIGN { 1 0 10303 214 1 1 1 1 }'));\nENDSEC;\nDATA;\n"
        )
        return (header + "\n".join(self.lines) + "\nENDSEC;\nEND-ISO-10303-21;\n").encode()


def _numbers(values: np.ndarray) -> str:
    return ",".join(f"{value:.9f}" for value in values + 0.0)

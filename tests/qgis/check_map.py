"""Checks the project and the picture that examples/qgis/map.py makes, by QGIS itself: scripts/check_qgis.

    python3 check_map.py map.qgz map.png EPSG:32635 HEIGHT X Y

HEIGHT: that of the terrain at X, Y on the map.
"""

from __future__ import annotations

import os
import sys

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from qgis.core import QgsApplication, QgsPointXY, QgsProject  # noqa: E402
from qgis.PyQt.QtGui import QImage  # noqa: E402


def check(what: str, good: bool, told: object) -> None:
    if not good:
        sys.exit(f"check_map: {what}: {told}")
    print(f"ok  {what}: {told}")


def check_layers(project: QgsProject, crs: str, height: float, x: float, y: float) -> None:
    layers = {layer.name(): layer for layer in project.mapLayers().values()}
    check("layers", sorted(layers) == ["Contour lines", "Orthophoto", "Relief"], sorted(layers))
    check("their files", all(layer.isValid() for layer in layers.values()), "are read")
    maps = {layers[name].crs().authid() for name in ("Orthophoto", "Relief")} | {project.crs().authid()}
    check("maps", maps == {crs}, maps)
    value, is_there = layers["Relief"].dataProvider().sample(QgsPointXY(x, y), 1)
    check("height", is_there and abs(value - height) < 0.5, f"{value:.2f} at {x} {y}, made with {height:.2f}")
    lines = list(layers["Contour lines"].getFeatures())
    bold = [line["elevation"] for line in lines if line["index"]]
    check("contour lines", bool(lines) and 0 < len(bold) < len(lines) and all(z % 50 == 0 for z in bold), f"{len(lines)}, {len(bold)} of them bold")


def check_picture(path: str) -> None:
    picture = QImage(path)
    places = [(x, y) for x in range(0, picture.width(), 8) for y in range(0, picture.height(), 8)]
    shades = {picture.pixelColor(x, y).lightness() for x, y in places}
    check("picture", picture.width() > 600 and len(shades) > 30, f"{picture.width()} x {picture.height()}, {len(shades)} shades")


def main() -> None:
    project_file, picture, crs = sys.argv[1:4]
    application = QgsApplication([], False)
    application.initQgis()
    project = QgsProject.instance()
    check("project", project.read(project_file), project_file)
    check_layers(project, crs, *map(float, sys.argv[4:7]))
    check_picture(picture)
    project.clear()
    application.exitQgis()


main()

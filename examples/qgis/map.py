# SPDX-License-Identifier: MIT
"""A QGIS project and a map of what meshhier writes: an orthophoto, heights as relief over it, and contour lines. docs/recipes/qgis.md.

    python3 map.py ortho.tif dsm.tif contours.geojson -o map.qgz --picture map.png
"""

from __future__ import annotations

import argparse
import math
import os
import sys

os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")

from qgis.core import (  # noqa: E402
    QgsApplication,
    QgsHillshadeRenderer,
    QgsLayout,
    QgsLayoutExporter,
    QgsLayoutItemMap,
    QgsLayoutItemScaleBar,
    QgsLayoutPoint,
    QgsLayoutSize,
    QgsLineSymbol,
    QgsPalLayerSettings,
    QgsProject,
    QgsRasterLayer,
    QgsRuleBasedRenderer,
    QgsTextFormat,
    QgsUnitTypes,
    QgsVectorLayer,
    QgsVectorLayerSimpleLabeling,
)
from qgis.PyQt.QtCore import QRectF  # noqa: E402
from qgis.PyQt.QtGui import QPainter  # noqa: E402


def raster(path: str, name: str) -> QgsRasterLayer:
    layer = QgsRasterLayer(path, name)
    if not layer.isValid():
        sys.exit(f"{path}: QGIS does not read it")
    return layer


def relief(path: str) -> QgsRasterLayer:
    """Shades of heights, which darken what is below."""
    layer = raster(path, "Relief")
    layer.setRenderer(QgsHillshadeRenderer(layer.dataProvider(), 1, 315, 45))
    layer.renderer().setZFactor(3)
    layer.setOpacity(0.7)
    layer.setBlendMode(QPainter.CompositionMode_Multiply)
    return layer


def contours(path: str) -> QgsVectorLayer:
    """Each fifth line is bolder and has its height, as meshhier marks it by `index`."""
    layer = QgsVectorLayer(path, "Contour lines", "ogr")
    if not layer.isValid():
        sys.exit(f"{path}: QGIS does not read it")
    rules = QgsRuleBasedRenderer.Rule(None)
    for condition, width in (('not "index"', "0.1"), ('"index"', "0.3")):
        symbol = QgsLineSymbol.createSimple({"color": "#6b4a2b", "width": width})
        rules.appendChild(QgsRuleBasedRenderer.Rule(symbol, filterExp=condition))
    layer.setRenderer(QgsRuleBasedRenderer(rules))
    labels = QgsPalLayerSettings()
    labels.fieldName = "if(\"index\", \"elevation\", '')"
    labels.isExpression = True
    labels.placement = QgsPalLayerSettings.Curved
    text = QgsTextFormat()
    text.setSize(7)
    labels.setFormat(text)
    layer.setLabeling(QgsVectorLayerSimpleLabeling(labels))
    layer.setLabelsEnabled(True)
    return layer


def round_length(length: float) -> float:
    """1, 2 or 5 times a power of ten, no longer than that."""
    ten = 10.0 ** math.floor(math.log10(length))
    return max(step * ten for step in (1, 2, 5) if step * ten <= length)


def export_map(project: QgsProject, ground: QgsRasterLayer, path: str) -> None:
    """A sheet of 160 mm with the whole orthophoto and a scale bar."""
    extent = ground.extent()
    width, height = 160.0, 160.0 * extent.height() / extent.width()
    layout = QgsLayout(project)
    layout.initializeDefaults()
    layout.pageCollection().page(0).setPageSize(QgsLayoutSize(width, height))
    sheet = QgsLayoutItemMap(layout)
    sheet.attemptSetSceneRect(QRectF(0, 0, width, height))
    sheet.setExtent(extent)
    layout.addLayoutItem(sheet)
    bar = QgsLayoutItemScaleBar(layout)
    bar.setLinkedMap(sheet)
    bar.applyDefaultSize(QgsUnitTypes.DistanceKilometers)
    bar.setUnitsPerSegment(round_length(extent.width() / 8000))
    bar.setBackgroundEnabled(True)
    layout.addLayoutItem(bar)
    bar.attemptMove(QgsLayoutPoint(4, height - 18))
    settings = QgsLayoutExporter.ImageExportSettings()
    settings.dpi = 110
    if QgsLayoutExporter(layout).exportToImage(path, settings) != QgsLayoutExporter.Success:
        sys.exit(f"{path}: QGIS does not write it")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("orthophoto")
    parser.add_argument("heights")
    parser.add_argument("contours")
    parser.add_argument("-o", dest="project", required=True, help="the project, .qgz")
    parser.add_argument("--picture", help="a map of all of it, .png")
    wanted = parser.parse_args()
    application = QgsApplication([], False)
    application.initQgis()
    project = QgsProject.instance()
    ground = raster(wanted.orthophoto, "Orthophoto")
    project.setCrs(ground.crs())
    for layer in (ground, relief(wanted.heights), contours(wanted.contours)):
        project.addMapLayer(layer)
    if wanted.picture:
        export_map(project, ground, wanted.picture)
    if not project.write(wanted.project):
        sys.exit(f"{wanted.project}: QGIS does not write it")
    project.clear()
    application.exitQgis()


if __name__ == "__main__":
    main()

// SPDX-License-Identifier: MIT
// Contours as GeoJSON: longitude, latitude and metres where the model is placed on the globe, else its own coordinates.
import type { Contour } from './contours.js';
import type { GlobePlace } from './coordinates.js';
import { walked, type DrawingFrame, type ToInput } from './line_drawing.js';
import { dot, type Vector } from './vectors.js';

/// A tenth of a millimetre.
const [DEGREE_DIGITS, METRE_DIGITS] = [9, 4];

/// `toGlobe`: of a point of the input; null: the model has no place. Else places are along the axes of the frame, heights the last.
export function contourGeoJson(contours: readonly Contour[], frame: DrawingFrame, toInput: ToInput, toGlobe: (point: Vector) => GlobePlace | null): string {
  let isPlaced = false;
  const placeOf = (point: Vector): number[] => {
    const at = toInput(point);
    const globe = toGlobe(at);
    isPlaced = globe !== null;
    if (globe === null) return frame.map((axis) => dot(axis, at) + 0);
    return [Number(globe.longitude.toFixed(DEGREE_DIGITS)), Number(globe.latitude.toFixed(DEGREE_DIGITS)), Number(globe.height.toFixed(METRE_DIGITS))];
  };
  const features = contours.flatMap(({ height, isIndex, lines }) => lines.map(({ points, isClosed }) => JSON.stringify({
    type: 'Feature',
    properties: { elevation: height, index: isIndex, closed: isClosed },
    geometry: { type: 'LineString', coordinates: walked(points.map(placeOf), isClosed) },
  })));
  const of = isPlaced ? '' : '"coordinates_of":"the model, as it has no place on the globe",';
  return `{"type":"FeatureCollection",${of}"features":[\n${features.join(',\n')}\n]}\n`;
}

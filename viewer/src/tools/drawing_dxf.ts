// SPDX-License-Identifier: MIT
// A drawing as DXF of AutoCAD 2000 (AC1015), in true units: pairs of lines, a group's code and its value.
//
//     HEADER     unit, extent
//     TABLES     layers, and what every file has to have
//     BLOCKS     two empty ones, which stand for the model and the paper
//     ENTITIES   LWPOLYLINE for lines, at their heights; TEXT for labels
//     OBJECTS    an empty dictionary
import { lengthOfLine, middleOf, type DrawnLine } from './line_drawing.js';
import { TEXT_HEIGHT, type Flat, type Paper, type PaperLine } from './paper.js';
import type { UnitName } from './units.js';

/// $INSUNITS.
const UNITS: Readonly<Record<UnitName, number>> = { unit: 0, mm: 4, cm: 5, m: 6, km: 7, in: 1, ft: 2, ftUS: 21 };

/// AutoCAD's numbers of colours; hundredths of a millimetre, -3: as usual.
const LAYERS = {
  0: { colour: 7, weight: -3 },
  SECTION: { colour: 7, weight: 35 },
  CONTOUR: { colour: 33, weight: 13 },
  CONTOUR_INDEX: { colour: 34, weight: 35 },
  CONTOUR_LABEL: { colour: 34, weight: 13 },
  GRID: { colour: 8, weight: 9 },
  SCALE: { colour: 7, weight: 18 },
} as const;
type Layer = keyof typeof LAYERS;

const LEAST_LABELLED = 10; // of a label's height
const [MODEL, PAPER] = ['1F', '1B'];
const SPACES = [[MODEL, '*Model_Space'], [PAPER, '*Paper_Space']] as const;

type Value = number | string;

/// Texts that are no ASCII are escaped as DXF has it.
function ascii(text: string): string {
  return text.replace(/[\r\n]+/g, ' ').replace(/[^\x20-\x7e]/g, (letter) => `\\U+${letter.charCodeAt(0).toString(16).toUpperCase().padStart(4, '0')}`);
}

/// Takes groups; what has a handle of its own gets the next one.
class Groups {
  private readonly lines: string[] = [];
  private next = 0x100;

  /// Codes and values in turn.
  put(...pairs: readonly Value[]): this {
    for (let i = 0; i < pairs.length; i += 2) this.lines.push(`${String(pairs[i]).padStart(3)}\n${pairs[i + 1]}\n`);
    return this;
  }

  handle(): this {
    return this.put(5, (this.next++).toString(16).toUpperCase());
  }

  table(name: string, handle: string, rows: number, fill: () => void): void {
    this.put(0, 'TABLE', 2, name, 5, handle, 330, 0, 100, 'AcDbSymbolTable', 70, rows);
    fill();
    this.put(0, 'ENDTAB');
  }

  row(kind: string, table: string, subclass: string, name: string): this {
    return this.put(0, kind).handle().put(330, table, 100, 'AcDbSymbolTableRecord', 100, subclass, 2, name, 70, 0);
  }

  entity(kind: string, layer: Layer, subclass: string): this {
    return this.put(0, kind).handle().put(330, MODEL, 100, 'AcDbEntity', 8, layer, 100, subclass);
  }

  toString(): string {
    return this.lines.join('');
  }
}

interface Bounds {
  readonly least: Flat;
  readonly most: Flat;
}

function putHeader(dxf: Groups, unit: UnitName, { least, most }: Bounds): void {
  dxf.put(0, 'SECTION', 2, 'HEADER', 9, '$ACADVER', 1, 'AC1015', 9, '$DWGCODEPAGE', 3, 'ANSI_1252', 9, '$INSUNITS', 70, UNITS[unit], 9, '$MEASUREMENT', 70, 1);
  dxf.put(9, '$EXTMIN', 10, least[0], 20, least[1], 30, 0, 9, '$EXTMAX', 10, most[0], 20, most[1], 30, 0, 9, '$HANDSEED', 5, 'FFFFFFFFFFFF', 0, 'ENDSEC');
}

function putTables(dxf: Groups, { least, most }: Bounds): void {
  dxf.put(0, 'SECTION', 2, 'TABLES');
  dxf.table('VPORT', '8', 1, () => {
    const [middleX, middleY] = [(least[0] + most[0]) / 2, (least[1] + most[1]) / 2];
    dxf.row('VPORT', '8', 'AcDbViewportTableRecord', '*Active').put(10, 0, 20, 0, 11, 1, 21, 1, 12, middleX, 22, middleY, 40, 1.1 * Math.max(most[0] - least[0], most[1] - least[1], 1e-9), 41, 1.5);
  });
  dxf.table('LTYPE', '5', 3, () => {
    for (const name of ['ByBlock', 'ByLayer', 'Continuous']) dxf.row('LTYPE', '5', 'AcDbLinetypeTableRecord', name).put(3, '', 72, 65, 73, 0, 40, 0);
  });
  dxf.table('LAYER', '2', Object.keys(LAYERS).length, () => {
    for (const [name, { colour, weight }] of Object.entries(LAYERS)) dxf.row('LAYER', '2', 'AcDbLayerTableRecord', name).put(62, colour, 6, 'Continuous', 370, weight, 390, 'F');
  });
  dxf.table('STYLE', '3', 1, () => { dxf.row('STYLE', '3', 'AcDbTextStyleTableRecord', 'Standard').put(40, 0, 41, 1, 50, 0, 71, 0, 42, 1, 3, 'txt', 4, ''); });
  for (const [name, handle] of [['VIEW', '6'], ['UCS', '7']]) dxf.table(name, handle, 0, () => undefined);
  dxf.table('APPID', '9', 1, () => { dxf.row('APPID', '9', 'AcDbRegAppTableRecord', 'ACAD'); });
  dxf.table('DIMSTYLE', 'A', 1, () => {
    dxf.put(100, 'AcDbDimStyleTable', 71, 0, 0, 'DIMSTYLE', 105, '27', 330, 'A', 100, 'AcDbSymbolTableRecord', 100, 'AcDbDimStyleTableRecord', 2, 'Standard', 70, 0);
  });
  dxf.table('BLOCK_RECORD', '1', 2, () => {
    for (const [handle, name] of SPACES) dxf.put(0, 'BLOCK_RECORD', 5, handle, 330, '1', 100, 'AcDbSymbolTableRecord', 100, 'AcDbBlockTableRecord', 2, name, 340, 0);
  });
  dxf.put(0, 'ENDSEC');
}

function putBlocks(dxf: Groups): void {
  dxf.put(0, 'SECTION', 2, 'BLOCKS');
  for (const [record, name] of SPACES) {
    dxf.put(0, 'BLOCK').handle().put(330, record, 100, 'AcDbEntity', 8, '0', 100, 'AcDbBlockBegin', 2, name, 70, 0, 10, 0, 20, 0, 30, 0, 3, name, 1, '');
    dxf.put(0, 'ENDBLK').handle().put(330, record, 100, 'AcDbEntity', 8, '0', 100, 'AcDbBlockEnd');
  }
  dxf.put(0, 'ENDSEC');
}

function putObjects(dxf: Groups): void {
  dxf.put(0, 'SECTION', 2, 'OBJECTS', 0, 'DICTIONARY', 5, 'C', 330, 0, 100, 'AcDbDictionary', 281, 1, 3, 'ACAD_GROUP', 350, 'D', 3, 'ACAD_PLOTSTYLENAME', 350, 'E');
  dxf.put(0, 'DICTIONARY', 5, 'D', 330, 'C', 100, 'AcDbDictionary', 281, 1);
  dxf.put(0, 'ACDBDICTIONARYWDFLT', 5, 'E', 330, 'C', 100, 'AcDbDictionary', 281, 1, 3, 'Normal', 350, 'F', 100, 'AcDbDictionaryWithDefault', 340, 'F');
  dxf.put(0, 'ACDBPLACEHOLDER', 5, 'F', 330, 'E', 0, 'ENDSEC', 0, 'EOF');
}

function putLine(dxf: Groups, layer: Layer, points: readonly Flat[], isClosed: boolean, height: number): void {
  dxf.entity('LWPOLYLINE', layer, 'AcDbPolyline').put(90, points.length, 70, isClosed ? 1 : 0, 38, height);
  for (const [x, y] of points) dxf.put(10, x, 20, y);
}

interface Text {
  readonly text: string;
  readonly at: Flat;
  readonly height: number;
  readonly size: number;
  /// Degrees.
  readonly angle: number;
  /// 0: from there to the right, 1: around it.
  readonly anchor: number;
}

function putText(dxf: Groups, layer: Layer, { text, at: [x, y], height, size, angle, anchor }: Text): void {
  dxf.entity('TEXT', layer, 'AcDbText').put(10, x, 20, y, 30, height, 40, size, 1, ascii(text), 50, angle, 72, anchor, 11, x, 21, y, 31, height, 100, 'AcDbText', 73, 0);
}

function putLabel(dxf: Groups, line: DrawnLine, size: number): void {
  const middle = line.label === undefined || lengthOfLine(line) < LEAST_LABELLED * size ? null : middleOf(line);
  if (middle === null) return;
  const { at, along: [x, y] } = middle;
  putText(dxf, 'CONTOUR_LABEL', { text: line.label!, at, height: line.height, size, angle: (Math.atan2(y, x) * 180) / Math.PI, anchor: 1 });
}

/// The drawing's coordinates are the input's along the axes; the paper's grid and scale bar are there in true size.
export function drawingDxf(lines: readonly DrawnLine[], paper: Paper, unit: UnitName): string {
  const { extent, margin, mmPerUnit } = paper;
  const fromPaper = ([x, y]: Flat): Flat => [extent.left + (x - margin) / mmPerUnit, extent.top - (y - margin) / mmPerUnit];
  const bounds = { least: fromPaper([0, paper.height]), most: fromPaper([paper.width, 0]) };
  const size = TEXT_HEIGHT / mmPerUnit;
  const dxf = new Groups();
  putHeader(dxf, unit, bounds);
  putTables(dxf, bounds);
  putBlocks(dxf);
  dxf.put(0, 'SECTION', 2, 'ENTITIES');
  const putMarks = (layer: Layer, marks: readonly PaperLine[]): void => { for (const { from, to } of marks) putLine(dxf, layer, [fromPaper(from), fromPaper(to)], false, 0); };
  putMarks('GRID', [...paper.grid, ...paper.frame]);
  putMarks('SCALE', paper.bar);
  for (const { at, text, anchor, isTurned } of paper.texts) putText(dxf, 'SCALE', { text, at: fromPaper(at), height: 0, size, angle: isTurned ? 90 : 0, anchor: ['start', 'middle', 'end'].indexOf(anchor) });
  for (const line of lines) {
    putLine(dxf, line.layer, line.points, line.isClosed, line.height);
    putLabel(dxf, line, size);
  }
  dxf.put(0, 'ENDSEC');
  putObjects(dxf);
  return dxf.toString();
}

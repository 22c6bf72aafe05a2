// Picks objects in the viewers of others, in headless Chromium, from a plain static server: what they tell of the things at random places
// of the picture is compared with what rays through these places meet in the tiles, and at the finest level in the original.
//
//   node picked_objects.mjs PICTURES HIERARCHY=OBJ=TABLE...
//
// The hierarchy was made from that OBJ, z up, and TABLE, a CSV file whose first columns, without quotes, are the name and a number. It is
// looked at along x. Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { call, inChromium, readHierarchy, SIZE, withPage } from './browser.mjs';
import { ObjectJudge } from './object_judge.mjs';
import { random } from './random.mjs';

/// Views, in radii of the model's sphere: where they look from, and at which places beside its middle.
const DIRECTION = [0.3, -1, 0.9];
const DISTANCE = 0.04;
const TARGETS = [-0.9, -0.3, 0.3, 0.6];
/// How many times a tile's error its `geometricError` is, by default.
const PIXELS_AN_ERROR = 16;
/// Pixels of error that tiles may have, where partitions and others are seen, and where only partitions are.
const MIDDLE = 40;
const EXACT = 1e-6;
const LEAST_PICKS = 20; // a level

const VIEWERS = [
  { viewer: 'three', missing: 0 }, // it tells 0 where a number has no value
  { viewer: 'cesium', missing: null },
];

/// What is looked at: few levels from the root on, some, the partitions. A model that is fine enough as nothing at all is not shown.
/// `places`: of a view. Where nothing is, as in gaps of coarse levels, nothing is picked.
function levelsOf({ root, geometricError }) {
  const { box } = root.boundingVolume;
  const away = DISTANCE * Math.hypot(...box.slice(3));
  const coarse = (Math.sqrt(root.geometricError * geometricError) / PIXELS_AN_ERROR) * (SIZE / away);
  return [
    { name: 'coarse', errorTarget: coarse, places: 800 },
    { name: 'middle', errorTarget: MIDDLE, places: 150 },
    { name: 'fine', errorTarget: EXACT, places: 150 },
  ];
}

/// The number of each name. Rows without a number, as names without a row, have none.
function readNumbers(table) {
  const [head, ...rows] = readFileSync(table, 'utf8').trim().split(/\r?\n/).map((line) => line.split(','));
  return { property: head[1], numbers: new Map(rows.map(([name, number]) => [name, number === '' ? null : Number(number)])) };
}

class Tally {
  picks = 0;
  original = 0;
  objects = new Set();
  wrong = [];

  constructor({ judge, property, numbers }, missing) {
    Object.assign(this, { judge, property, numbers, missing });
  }

  /// `found`: the properties of the thing that was picked, where `ray` meets these tiles.
  add(found, ray, visible) {
    const { name } = found;
    const shown = this.judge.inTiles(visible, ray);
    const number = this.numbers.get(name) ?? this.missing;
    const told = found[this.property] ?? null;
    ++this.picks;
    this.objects.add(name);
    if (name !== shown) this.wrong.push(`${name}, not ${shown}`);
    if (told !== number) this.wrong.push(`${name} has ${told}, not ${number}`);
    if (name === this.judge.names[found.object]) this.original += name === this.judge.inOriginal(ray) ? 1 : 0;
    else this.wrong.push(`${name} is not object ${found.object}`);
  }
}

async function pick(page, { errorTarget, places }, next, tally) {
  const levels = [];
  for (const along of TARGETS) {
    await call(page, 'look', { direction: DIRECTION, distance: DISTANCE, target: [along, 0, 0] });
    const { visible, failures } = await call(page, 'settle', errorTarget);
    tally.wrong.push(...failures);
    const picked = Array.from({ length: places }, () => [0, 1].map(() => Math.floor(SIZE * next()) + 0.5)); // middles of pixels
    const rays = await call(page, 'raysThrough', picked);
    const found = await call(page, 'pickAll', picked);
    found.forEach((each, i) => each && tally.add(each, rays[i], visible));
    levels.push(...visible.map((file) => Number(/tiles\/(\d+)\//.exec(file)[1])));
  }
  return `levels ${Math.min(...levels)} to ${Math.max(...levels)}`;
}

async function pickLevels(page, { viewer, missing }, hierarchy, pictures, report) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json' });
  for (const level of hierarchy.levels) {
    const tally = new Tally(hierarchy, missing);
    const levels = await pick(page, level, random(3), tally);
    const { picks, original, objects, wrong } = tally;
    report.line(`${hierarchy.name} ${viewer} picked ${level.name}`,
      wrong.length === 0 && picks >= LEAST_PICKS && (level.errorTarget !== EXACT || original === picks),
      `${levels}: ${picks} picks of ${objects.size} objects have name and value of the triangle there, ${original} the name that the original has there` +
        wrong.slice(0, 5).map((each) => `; ${each}`).join(''));
    await page.screenshot({ path: path.join(pictures, `${hierarchy.name}-${viewer}-picked-${level.name}.png`) });
  }
}

async function pickAll(browser, report, pictures, given) {
  for (const [directory, obj, table] of given) {
    const levels = levelsOf(JSON.parse(readFileSync(path.join(directory, 'tileset.json'), 'utf8')));
    const hierarchy = { ...readHierarchy(directory), ...readNumbers(table), levels, judge: new ObjectJudge(obj, path.resolve(directory)) };
    for (const each of VIEWERS) {
      await withPage(browser, report, { viewer: each.viewer, name: hierarchy.name, directories: { '/hierarchy': hierarchy.directory } }, (page) =>
        pickLevels(page, each, hierarchy, pictures, report));
    }
  }
}

const [pictures, ...given] = process.argv.slice(2).map((argument, i) => (i > 0 ? argument.split('=') : argument));
if (given.length === 0 || given.some(({ length }) => length !== 3)) {
  console.log('usage: node picked_objects.mjs PICTURES HIERARCHY=OBJ=TABLE...');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => pickAll(browser, report, pictures, given)));

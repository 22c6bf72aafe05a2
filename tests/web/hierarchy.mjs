// The viewer's library over hierarchies, in headless Chromium, from a plain static server: no hole while levels mix,
// bytes of differences, the frame rate asked for, memory.
//
//   node hierarchy.mjs PICTURES HIERARCHY=MESH...
//
// All are looked at; bytes, rate and memory are told of the last. Of paths, sides and checks each share has an eighth. MESH: the closed mesh, a PLY file, that the hierarchy was made from.
// Pictures go to the directory PICTURES. Exit code 2: wrong use; else see browser.mjs.
import { readFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { call, inChromium, inTurn, readHierarchy, SLOW_LINE, withPage } from './browser.mjs';
import { random } from './random.mjs';

const VIEWER = path.join(path.dirname(fileURLToPath(import.meta.url)), '../../viewer');

const SEAM_FRAMES = 300; // of all models together
const SEAM_SIZE = 384;
const FRAMES_A_PATH = 20;
/// Pixels that a surface may have moved: more than its error, which is an estimate.
const REACH = (error) => Math.ceil(3 * error) + 2;
/// A silhouette that may be further off than this says nothing.
const MOST_REACH = 24;

/// Outside of the sphere around the model, looking at something in it.
function randomPose(next) {
  const around = () => 2 * next() - 1;
  const target = [around() / 4, around() / 4, around() / 4];
  return { direction: [around(), around(), around()], distance: 1.35 + 1.5 * next() ** 2, target };
}

function between(one, other, part) {
  const mix = (a, b) => a + (b - a) * part;
  const mixAll = (a, b) => a.map((each, k) => mix(each, b[k]));
  return {
    direction: mixAll(one.direction, other.direction),
    distance: mix(one.distance, other.distance),
    target: mixAll(one.target, other.target),
  };
}

/// The part of the frames that show several levels at least. Most do, but for an eighth of the paths, whose views are near the finest.
const MIXED = 1 / 20;

/// Where tiles come slowly, more views say nothing: then all are looked at again, as they are by then.
const MOST_ROUNDS = 20;

/// Twice as many as are looked at: some views say nothing.
function seamPaths(frames) {
  const next = random(11);
  const paths = Array.from({ length: (2 * frames) / FRAMES_A_PATH }, (_, i) =>
    ({ from: randomPose(next), to: randomPose(next), threshold: [0.25, 0.5, 1, 2][Math.floor(i / 4) % 4] }));
  return inTurn(paths);
}

async function checkSeams(page, name, most, pictures, report) {
  const paths = seamPaths(most);
  const frames = (paths.length * FRAMES_A_PATH) / 2;
  let told = 0;
  let holes = 0;
  let cracks = 0;
  let covered = 0;
  let mixed = 0;
  for (const { from, to, threshold } of Array.from({ length: MOST_ROUNDS }, () => paths).flat()) {
    if (told === frames) break;
    await call(page, 'set', { threshold });
    for (let step = 0; step < FRAMES_A_PATH && told < frames; ++step) {
      await call(page, 'pose', between(from, to, step / FRAMES_A_PATH));
      const { worstError, finestLevel, coarsestLevel } = await call(page, 'frame');
      const reach = REACH(worstError);
      if (reach > MOST_REACH) continue;
      const found = await call(page, 'holes', reach);
      holes += found.holes;
      cracks += found.cracks;
      covered += found.covered;
      ++told;
      if (finestLevel > coarsestLevel) ++mixed;
      if (found.holes + found.cracks > 0) await page.screenshot({ path: path.join(pictures, `${name}-hole-${told}.png`) });
    }
  }
  report.line(`${name} seams`, holes + cracks === 0 && told === frames && mixed > frames * MIXED,
    `${told} frames, ${mixed} of them of several levels: ${holes} pixels of the background where the mesh covers ${covered}, ` +
      `${cracks} where a ray enters more or less often than it leaves`);
}

const SIDES = [[1, 0.2, 0], [-1, 0.2, 0], [0, 1, 0.1], [0, -1, 0.1], [0, 0.2, 1], [0, 0.2, -1]];
/// Times the error allowed, which is an estimate of the mean.
const MOST_DEVIATION = 6;

/// From all sides, what is seen is as fine as was asked for: nothing in sight is taken for hidden.
async function checkFaithful(page, name, report) {
  const sides = inTurn(SIDES);
  if (sides.length === 0) return;
  await call(page, 'reopen');
  let worst = 0;
  let backs = 0;
  for (const direction of sides) {
    await call(page, 'pose', { direction, distance: 1.6 });
    await call(page, 'settle');
    worst = Math.max(worst, (await call(page, 'deviation')).pixels);
    backs += await call(page, 'backs');
  }
  report.line(`${name} faithful`, worst <= MOST_DEVIATION, `at rest ${worst.toFixed(2)} pixels from the original at the most, at 99 of 100 places, from ${sides.length} sides`);
  report.line(`${name} silhouettes`, backs <= sides.length, `${backs} pixels where backs shine through`);
}

/// Recorded in the page of viewer/ each half a second, over the dragon: drags, wheel and glides; around the model, down to it, along
/// it. A line: the direction from the target to the camera; their distance; the target, from the middle of the model's bounding
/// sphere; both in its radii.
const PATHS = Object.entries(JSON.parse(readFileSync(new URL('camera_paths.json', import.meta.url), 'utf8'))).map(([way, lines]) => {
  const stops = lines.map(([x, y, z, distance, ...target]) => ({ direction: [x, y, z], distance, target }));
  return { way, stops };
});

/// Views at rest become no finer than moving ones.
const AS_ASKED = { settings: { restDetail: 1 } };

async function checkDifferences(page, { name }, report) {
  for (const { way, stops } of PATHS) {
    await call(page, 'reopen', AS_ASKED);
    let last;
    for (const stop of stops) {
      await call(page, 'pose', stop);
      last = await call(page, 'settle');
    }
    const ratio = last.wholeViewBytes / last.fetchedBytes;
    report.line(`${name} differences ${way}`, ratio >= 5,
      `${stops.length} views whole ${last.wholeViewBytes} bytes, sent ${last.fetchedBytes}: ${ratio.toFixed(1)} times fewer; ${last.hits} hits`);
  }
}

const LATENCY_STEP = 5; // each fifth stop

/// How long a view takes behind a slow line, and how long to fetch it whole; told, no more.
async function tellLatency(page, { name }, report) {
  const session = await page.context().newCDPSession(page);
  await session.send('Network.enable');
  await call(page, 'reopen', AS_ASKED);
  await session.send('Network.emulateNetworkConditions', SLOW_LINE);
  for (const { way, stops } of PATHS) {
    const took = { differences: 0, whole: 0 };
    const [start, ...others] = stops.filter((_, i) => i % LATENCY_STEP === 0);
    await call(page, 'pose', start); // from elsewhere: not counted
    await call(page, 'settle');
    for (const stop of others) {
      await call(page, 'pose', stop);
      const settled = await call(page, 'settle');
      took.differences += settled.took;
      took.whole += await call(page, 'fetchWhole');
    }
    const [mean, whole] = [took.differences, took.whole].map((sum) => sum / others.length);
    report.line(`${name} latency ${way}`, true, `${mean.toFixed(0)} ms a view, ${whole.toFixed(0)} to fetch it whole: ${(whole / mean).toFixed(1)} times`);
  }
  await session.detach();
}

const RATE = 30;
const SETTLE_SECONDS = 2;

/// A device that shows half of what the view asks for at the rate asked for.
async function checkFrameRate(page, { name }, report) {
  await call(page, 'reopen', AS_ASKED);
  await call(page, 'set', { framesPerSecond: RATE, threshold: 0.25 });
  await call(page, 'pose', { direction: [1, 0.3, 0], distance: 1.6 });
  const full = await call(page, 'settle');
  const base = 4;
  const perTriangle = (1000 / RATE - base) / (0.5 * full.triangles);
  const frames = await call(page, 'circle', { seconds: 8, base, perTriangle, distance: 1.6 });
  const settled = frames.filter(({ at }) => at >= 1000 * SETTLE_SECONDS);
  const rates = windows(settled.map(({ took }) => took), 10).map((mean) => 1000 / mean);
  const turns = turnsOf(settled.map(({ vertexBudget }) => vertexBudget));
  const good = rates.every((rate) => Math.abs(rate / RATE - 1) <= 0.15);
  const rest = await call(page, 'settle');
  const isFull = rest.worstError <= 0.25 * 1.3;
  report.line(`${name} frame rate`, good && isFull && turns <= 6,
    `from ${(1000 / frames[1].took).toFixed(1)} a second to ${Math.min(...rates).toFixed(1)} … ${Math.max(...rates).toFixed(1)} after ` +
      `${SETTLE_SECONDS} s (asked for: ${RATE}), ${settled.at(-1).triangles} of ${full.triangles} triangles, budget turned ${turns} times; at rest error ${rest.worstError.toFixed(2)}`);
}

function windows(values, length) {
  const means = [];
  for (let i = 0; i + length <= values.length; i += length)
    means.push(values.slice(i, i + length).reduce((sum, value) => sum + value, 0) / length);
  return means;
}

/// How often a series turns from growing to shrinking or back.
function turnsOf(values) {
  const steps = values.slice(1).map((value, i) => Math.sign(value - values[i])).filter((step) => step !== 0);
  return steps.slice(1).filter((step, i) => step !== steps[i]).length;
}

const HOUR_STEPS = 900;

/// So many times the root, which may have a normal map: room for two levels below it, and for a tile on its way.
const MEMORY_OF_ROOTS = 6;

/// Bytes of the root's tile, which is all that a view from far away shows.
async function rootBytes(page) {
  await call(page, 'reopen', AS_ASKED);
  await call(page, 'pose', { direction: [1, 0.3, 0], distance: 400 });
  const { residentTiles, residentBytes } = await call(page, 'settle');
  return residentBytes / residentTiles;
}

/// An hour, a look each four seconds, with a budget that holds a part of the model.
async function checkMemory(page, { name }, report) {
  const memoryBudget = Math.round(MEMORY_OF_ROOTS * (await rootBytes(page)));
  await call(page, 'reopen', { settings: { ...AS_ASKED.settings, memoryBudget }, size: 256 });
  await call(page, 'wander', { steps: HOUR_STEPS / 6, milliseconds: 4000, seed: 1 });
  const heapEarly = await call(page, 'heap');
  const late = await call(page, 'wander', { steps: HOUR_STEPS, milliseconds: 4000, seed: 2 });
  const heapLate = await call(page, 'heap');
  const left = await call(page, 'close');
  const good = late.peakBytes <= memoryBudget && late.evicted > 20 && late.problems.length === 0 &&
    late.geometries <= late.mostTiles && left.geometries === 0 && heapLate <= heapEarly + 8e6;
  report.line(`${name} memory`, good,
    `peak ${late.peakBytes} of ${memoryBudget} bytes, ${late.fetchedFiles} files fetched, ${late.evicted} tiles dropped; at most ${late.geometries} geometries of ${late.mostTiles} tiles, ` +
      `${left.geometries} left in the end; heap ${(heapEarly / 1e6).toFixed(1)} MB after ten minutes, ${(heapLate / 1e6).toFixed(1)} in the end${late.problems.join('; ')}`);
}

async function checkPicture(page, hierarchy, pictures, report) {
  const { name, mesh, frames } = hierarchy;
  const original = `/mesh/${path.basename(mesh)}`;
  await call(page, 'open', { url: '/hierarchy', size: SEAM_SIZE, original });
  await checkSeams(page, name, frames, pictures, report);
  await checkFaithful(page, name, report);
}

async function checkTraffic(page, hierarchy, report) {
  for (const check of inTurn([checkDifferences, tellLatency, checkFrameRate, checkMemory])) await check(page, hierarchy, report);
}

async function check(page, hierarchy, isLast, pictures, report) {
  await checkPicture(page, hierarchy, pictures, report);
  if (isLast) await checkTraffic(page, hierarchy, report);
}

const [pictures, ...pairs] = process.argv.slice(2);
if (pairs.length === 0) {
  console.log('usage: node hierarchy.mjs PICTURES HIERARCHY=MESH...');
  process.exit(2);
}
process.exit(
  await inChromium(pictures, async (browser, report) => {
    for (const pair of pairs) {
      const [directory, mesh] = pair.split('=');
      const hierarchy = { ...readHierarchy(directory), mesh, frames: Math.ceil(SEAM_FRAMES / pairs.length) };
      const directories = {
        '/viewer': path.join(VIEWER, 'dist'),
        '/packages': path.join(VIEWER, 'node_modules'),
        '/hierarchy': hierarchy.directory,
        '/mesh': path.dirname(path.resolve(mesh)),
      };
      await withPage(browser, report, { viewer: 'hierarchy', name: hierarchy.name, directories }, (page) =>
        check(page, hierarchy, pair === pairs.at(-1), pictures, report));
    }
  }),
);

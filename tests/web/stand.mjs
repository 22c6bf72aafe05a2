// Whether hierarchies of a steeple (steeple.mjs) stand upright, with east and north where they belong:
// in 3d-tiles-renderer and CesiumJS, or at a place on CesiumJS's globe.
//
//   node stand.mjs PICTURES HIERARCHY[=LONGITUDE,LATITUDE,HEIGHT]...
//
// The place is that of the middle of the steeple's foot, as the config has it. Exit code 2: wrong use;
// else see browser.mjs.
import path from 'node:path';
import { call, inChromium, readHierarchy, withPage } from './browser.mjs';

const EARTH_RADIUS = 6.371e6;
// From where the steeple's middle may be away, in parts of its radius: geodesy as simple as this.
const NEAR = 0.01;
// The channel of the colour that the steeple shows to who stands there.
const SIDES = [
  { name: 'east', direction: [1, 0, 0], channel: 0 },
  { name: 'north', direction: [0, 1, 0], channel: 1 },
];

function standsUpright({ lower, upper, colour }, channel) {
  const others = Math.max(...colour.filter((_, i) => i !== channel));
  // The lower half of a triangle has three quarters of it.
  return lower > 2.5 * upper && upper > 100 && colour[channel] > 2 * others;
}

async function lookAround(page, what, report) {
  for (const { name, direction, channel } of SIDES) {
    await call(page, 'look', { direction, distance: 3 });
    const { failures } = await call(page, 'settle', 1);
    const seen = await call(page, 'stand');
    report.line(
      `${what} from ${name}`,
      failures.length === 0 && standsUpright(seen, channel),
      `${seen.lower} pixels in the lower half, ${seen.upper} in the upper, ` +
        `colour ${seen.colour.map(Math.round)}${failures.map((failure) => `; ${failure}`).join('')}`,
    );
  }
}

/// How far the model's middle is from above the place, and from half its height above it.
function judgePlace(report, what, { longitude, latitude, height, radius }, place) {
  const radians = Math.PI / 180;
  const east = (longitude - place[0]) * Math.cos(place[1] * radians) * radians * EARTH_RADIUS;
  const north = (latitude - place[1]) * radians * EARTH_RADIUS;
  const level = Math.hypot(east, north), above = height - place[2];
  report.line(
    what,
    level < NEAR * radius && above > 0.5 * radius && above < radius,
    `the middle is ${level.toFixed(2)} m beside and ${above.toFixed(2)} m above the place, radius ${radius.toFixed(1)} m`,
  );
}

async function showPlaced(page, { name, place }, pictures, report) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json', placed: true });
  judgePlace(report, `${name} place`, await call(page, 'place'), place);
  await lookAround(page, `${name} cesium`, report);
  await call(page, 'look', { direction: [2, 1.5, 1], distance: 3 });
  await call(page, 'showGlobe', true);
  await page.screenshot({ path: path.join(pictures, `${name}-globe.png`) });
}

async function showUnplaced(page, viewer, { name }, pictures, report) {
  await call(page, 'load', { tileset: '/hierarchy/tileset.json' });
  await lookAround(page, `${name} ${viewer}`, report);
  await page.screenshot({ path: path.join(pictures, `${name}-${viewer}.png`) });
}

async function showAll(browser, report, pictures, pairs) {
  for (const [directory, place] of pairs) {
    const hierarchy = { ...readHierarchy(directory), place: place?.split(',').map(Number) };
    const directories = { '/hierarchy': hierarchy.directory };
    const { name } = hierarchy;
    if (place) {
      await withPage(browser, report, { viewer: 'cesium', name, directories }, (page) =>
        showPlaced(page, hierarchy, pictures, report));
      continue;
    }
    for (const viewer of ['three', 'cesium']) {
      await withPage(browser, report, { viewer, name, directories }, (page) =>
        showUnplaced(page, viewer, hierarchy, pictures, report));
    }
  }
}

const [pictures, ...hierarchies] = process.argv.slice(2);
if (hierarchies.length === 0) {
  console.log('usage: node stand.mjs PICTURES HIERARCHY[=LONGITUDE,LATITUDE,HEIGHT]...');
  process.exit(2);
}
const pairs = hierarchies.map((argument) => argument.split('='));
process.exit(await inChromium(pictures, (browser, report) => showAll(browser, report, pictures, pairs)));

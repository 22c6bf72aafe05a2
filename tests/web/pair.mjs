// Two models in one view of viewer/'s page, in headless Chromium: each side of a swipe has the pixels of that model alone, both stay within
// one budget, points are those of the model that is seen there, and one that cannot be had leaves the other one as it is.
//
//   node pair.mjs MESHHIER PICTURES PAGE HIERARCHY.hier MESH [CHECK...]
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. HIERARCHY was built of MESH, which is built a second time with other
// settings. Pictures go to the directory PICTURES. CHECK: one of the checks below; all without any. Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { mkdtempSync, rmSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { addStyle, collectComplaints, decodePicture, inChromium, readHierarchy, until, withoutRestDetail } from './browser.mjs';
import { withSite } from './site.mjs';

const SIZE = { width: 640, height: 480 };
const TINTS = [[0x3b, 0x7d, 0xd8], [0xe8, 0x89, 0x2b]]; // src/pair/pair.ts
const LITTLE = 14e6; // bytes, of a budget that is too small for all of both
const BARE = '.top-bar, .zoom-bar, .pair-bar, .pair-divider, .busy, .problems { opacity: 0 !important; } .view { background: #fff !important; }';

class Comparison {
  constructor(browser, report, { origin, pictures, first, second }) {
    Object.assign(this, { browser, report, origin, pictures, first, second });
  }

  check(what, good, text) {
    this.report.line(`pair ${what}`, good, text);
  }

  async open(query, { hash = '', size = SIZE, bare = true } = {}) {
    const page = await this.browser.newPage({ viewport: size, reducedMotion: 'reduce' });
    await page.addInitScript(withoutRestDetail);
    page.complaints = [];
    collectComplaints(page, page.complaints, ['error', 'warning']);
    await page.goto(`${this.origin}/index.html?${query}${hash}`);
    if (bare) await addStyle(page, BARE);
    await settle(page);
    return page;
  }

  get both() {
    return `model=models/${this.first}.hier&with=models/${this.second}.hier`;
  }

  async close(page, what) {
    this.check(`${what} console`, page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
    await page.close();
  }

  async picture(page) {
    await settle(page);
    return decodePicture(page, await page.screenshot());
  }
}

async function settle(page) {
  await page.waitForFunction(() => window.meshhier?.settled());
  await page.evaluate(() => new Promise((done) => { requestAnimationFrame(() => requestAnimationFrame(done)); }));
}

/// Pixels of columns [from, to) that differ.
function differences(one, other, from, to, width = SIZE.width) {
  let count = 0;
  for (let i = 0; i < one.length / 4; ++i) {
    const x = i % width;
    if (x >= from && x < to && [0, 1, 2].some((k) => one[4 * i + k] !== other[4 * i + k])) ++count;
  }
  return count;
}

/// Pixels whose colour goes towards that one: its channels are in the same order, far enough apart.
function tinted(pixels, [r, g, b]) {
  let count = 0;
  for (let i = 0; i < pixels.length; i += 4) if ((pixels[i] - pixels[i + 2]) * Math.sign(r - b) > 40 && g > 0) ++count;
  return count;
}

const POSE = '#&0.9,1.4,2.6,0.1,0,0';

async function checkSwipe(visit, [alone, aloneOther]) {
  const page = await visit.open(visit.both, { hash: POSE });
  const told = (where, [left, right]) => visit.check(`swipe ${where}`, left === 0 && right === 0, `${left} pixels to the left and ${right} to the right are not those of each model alone`);
  const middle = SIZE.width / 2;
  const halves = await visit.picture(page);
  told('in the middle', [differences(halves, alone, 0, middle), differences(halves, aloneOther, middle, SIZE.width)]);
  visit.check('models differ', differences(alone, aloneOther, 0, SIZE.width) > 500, `${differences(alone, aloneOther, 0, SIZE.width)} pixels`);
  await page.evaluate(() => { document.querySelector('.pair-divider').focus(); });
  for (let i = 0; i < 5; ++i) await page.keyboard.press('ArrowLeft');
  const moved = await visit.picture(page);
  const at = Math.round(0.4 * SIZE.width);
  told('moved by keys', [differences(moved, alone, 0, at), differences(moved, aloneOther, at, SIZE.width)]);
  visit.check('link', await until(page, () => page.evaluate(() => location.hash.includes('divider=0.4'))), await page.evaluate(() => location.hash));
  await visit.close(page, 'swipe');
}

async function checkDrag(visit) {
  const page = await visit.open(visit.both, { hash: POSE, bare: false });
  await page.screenshot({ path: path.join(visit.pictures, 'pair-swipe.png') });
  await page.mouse.move(SIZE.width / 2, 200);
  await page.mouse.down();
  await page.mouse.move(SIZE.width / 4, 210, { steps: 4 });
  await page.mouse.up();
  const value = await page.locator('.pair-divider').getAttribute('aria-valuenow');
  visit.check('drag', value === '25', `the line is at ${value} %`);
  visit.check('drag leaves the camera', await page.evaluate(() => location.hash.startsWith('#&0.9,1.4,2.6,')), await page.evaluate(() => location.hash));
  await visit.close(page, 'drag');
}

async function checkSides(visit) {
  const half = { width: SIZE.width / 2, height: SIZE.height };
  const alone = [];
  for (const name of [visit.first, visit.second]) {
    const page = await visit.open(`model=models/${name}.hier`, { hash: POSE, size: half });
    alone.push(await visit.picture(page));
    await page.close();
  }
  const page = await visit.open(visit.both, { hash: `${POSE}&way=side` });
  const both = await visit.picture(page);
  const column = (first) => Buffer.concat(Array.from({ length: SIZE.height }, (_, y) => both.subarray(4 * (y * SIZE.width + first), 4 * (y * SIZE.width + first + half.width))));
  // The line between them is drawn over the first pixel of the second.
  const off = [differences(column(0), alone[0], 0, half.width, half.width), differences(column(half.width), alone[1], 1, half.width, half.width)];
  visit.check('side by side', off[0] === 0 && off[1] === 0, `${off.join(' and ')} pixels are others than those of each model alone in half the window`);
  await visit.close(page, 'side by side');
}

async function checkBlink(visit, alone) {
  const page = await visit.open(visit.both, { hash: `${POSE}&way=blink` });
  for (const [i, what] of ['the first', 'the second', 'the first again'].entries()) {
    if (i > 0) await page.keyboard.press('z');
    const off = differences(await visit.picture(page), alone[i % 2], 0, SIZE.width);
    visit.check(`blink shows ${what}`, off === 0, `${off} pixels are others than those of the model alone`);
  }
  await page.waitForTimeout(2000);
  visit.check('blink keeps still where less motion is asked for', differences(await visit.picture(page), alone[0], 0, SIZE.width) === 0, 'for two seconds');
  await visit.close(page, 'blink');
}

async function checkOverlay(visit) {
  const page = await visit.open(visit.both, { hash: `${POSE}&way=overlay`, bare: false });
  await page.screenshot({ path: path.join(visit.pictures, 'pair-overlay.png') });
  await addStyle(page, BARE);
  const pixels = await visit.picture(page);
  const counts = TINTS.map((tint) => tinted(pixels, tint));
  visit.check('overlay', counts.every((count) => count > 50), `${counts.join(' and ')} pixels of the two colours`);
  const names = await page.locator('.pair-name').allTextContents();
  visit.check('legend', names.join() === `${visit.first},${visit.second}`, names.join(', '));
  await visit.close(page, 'overlay');
}

async function checkBudget(visit) {
  const page = await visit.open(visit.both);
  const seen = await page.evaluate(async (memoryBudget) => {
    for (const view of [window.meshhier.view, window.meshhier.other]) view.setSettings({ memoryBudget, threshold: 0.2 });
    await new Promise((done) => { setTimeout(done, 1000); });
    const most = { bytes: 0, frames: 0 };
    for (let frame = 0; frame < 60; ++frame) {
      const turn = frame * 0.1;
      window.meshhier.setCamera({ position: [2.2 * Math.sin(turn), 0.6, 2.2 * Math.cos(turn)], target: [0.3 * Math.sin(turn), 0, 0.3 * Math.cos(turn)] });
      await new Promise((done) => { requestAnimationFrame(done); });
      most.bytes = Math.max(most.bytes, window.meshhier.pair().residentBytes);
      ++most.frames;
    }
    return most;
  }, LITTLE);
  await settle(page);
  const { views, residentBytes, memoryBudget } = await page.evaluate(() => window.meshhier.pair());
  visit.check('one memory budget', seen.bytes <= LITTLE && residentBytes <= memoryBudget && memoryBudget === LITTLE, `at most ${seen.bytes} of ${memoryBudget} bytes in ${seen.frames} frames`);
  visit.check('both have a share', views.every((view) => view.residentBytes > 0.1 * LITTLE), views.map((view) => view.residentBytes).join(' + '));
  await visit.close(page, 'budget');
}

async function checkPoints(visit) {
  const page = await visit.open(visit.both, { hash: POSE, bare: false });
  await page.evaluate(() => { window.meshhier.setCamera({ position: [0, 3, 0.01], target: [0, 0, 0] }); });
  await settle(page);
  await page.keyboard.press('i');
  await page.locator('.tool-card').waitFor();
  for (const [sign, name] of [[-1, visit.first], [1, visit.second]]) {
    const place = await page.evaluate((side) => {
      const { view } = window.meshhier;
      const x = ((view.box.max.x + view.box.min.x) / 2) + side * 0.8 * (view.box.max.x - view.box.min.x) / 2;
      const { width, height } = document.querySelector('.surface').getBoundingClientRect();
      return [width / 2 + (x / 3) * (height / 2) / Math.tan(Math.PI / 8), height / 2];
    }, sign);
    await page.mouse.click(...place);
    await page.waitForFunction((model) => [...document.querySelectorAll('.tool-figures dd')].some((each) => each.textContent === model), name).catch(() => undefined);
    await until(page, async () => (await page.locator('.tool-figures').innerText()).includes('the original, partition'));
    const rows = await page.locator('.tool-figures').innerText();
    const nearest = /Nearest of .*\n\s*([^\n]*)/.exec(rows)?.[1] ?? 'nothing';
    visit.check(`point on ${name}`, rows.includes(`On\n${name}`), rows.split('\n').join(' '));
    visit.check(`distance from ${name}`, Number.parseFloat(nearest) < 1e-6, `${nearest}: both are builds of one mesh`);
  }
  await page.screenshot({ path: path.join(visit.pictures, 'pair-points.png') });
  await visit.close(page, 'points');
}

async function checkFailures(visit, alone) {
  for (const [what, other, text] of [['is not there', 'models/none.hier', 'none cannot be opened'], ['is no address', 'javascript:alert(1)', 'is no address']]) {
    const page = await visit.open(`model=models/${visit.first}.hier&with=${encodeURIComponent(other)}`, { hash: POSE });
    visit.check(`a second model that ${what} is told`, await until(page, async () => (await page.locator('.problems').textContent()).includes(text)), await page.locator('.problems').textContent());
    visit.check(`the first one beside one that ${what}`, differences(await visit.picture(page), alone, 0, SIZE.width) === 0, 'as alone');
    await page.close();
  }
}

async function checkGallery(visit) {
  const page = await visit.browser.newPage({ viewport: SIZE });
  await page.goto(`${visit.origin}/index.html`);
  for (const name of [visit.first, visit.second]) {
    const cell = page.locator('.cells > li', { hasText: name }).first();
    await cell.hover();
    await cell.getByRole('button', { name: `Compare ${name}`, exact: true }).click();
  }
  await page.screenshot({ path: path.join(visit.pictures, 'pair-gallery.png') });
  await page.locator('.gallery-compare a').click();
  await settle(page);
  const address = await page.evaluate(() => location.search);
  visit.check('gallery', address === `?${visit.both}`, address);
  await page.close();
}

async function checkPhone(visit) {
  const page = await visit.open(visit.both, { size: { width: 360, height: 640 }, bare: false });
  const wide = await page.evaluate(() => [...document.querySelectorAll('.pair-bar, .pair-bar *')].filter((each) => each.checkVisibility() && each.getBoundingClientRect().right > innerWidth).length);
  visit.check('phone', wide === 0, `${wide} parts of the bar reach over the edge`);
  await page.screenshot({ path: path.join(visit.pictures, 'pair-phone.png') });
  await visit.close(page, 'phone');
}

/// `alone`: the pictures of each model alone.
const CHECKS = {
  swipe: checkSwipe, drag: checkDrag, sides: checkSides, blink: checkBlink, overlay: checkOverlay, budget: checkBudget, points: checkPoints,
  failures: (visit, [alone]) => checkFailures(visit, alone), gallery: checkGallery, phone: checkPhone,
};

async function main([meshhier, pictures, sources, hierarchy, mesh, ...checks]) {
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-pair-'));
  const first = readHierarchy(hierarchy);
  const other = path.join(work, 'coarse.hier');
  execFileSync(meshhier, ['build', mesh, '-o', other, '--set', 'partition.vertices=5000', '--progress', 'none']);
  const code = await inChromium(pictures, async (browser, report) => {
    await withSite(sources, [first, readHierarchy(other)], async (origin) => {
      const visit = new Comparison(browser, report, { origin, pictures, first: first.name, second: 'coarse' });
      const alone = [];
      for (const name of [visit.first, visit.second]) {
        const page = await visit.open(`model=models/${name}.hier`, { hash: POSE });
        alone.push(await visit.picture(page));
        await page.close();
      }
      for (const check of checks.length > 0 ? checks : Object.keys(CHECKS)) await CHECKS[check](visit, alone);
    });
  });
  rmSync(work, { recursive: true });
  return code;
}

if (process.argv.length >= 7) process.exitCode = await main(process.argv.slice(2));
else {
  console.error('usage: node pair.mjs MESHHIER PICTURES PAGE HIERARCHY.hier MESH');
  process.exitCode = 2;
}

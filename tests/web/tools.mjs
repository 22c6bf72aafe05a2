// Checks the tools of viewer/'s page in headless Chromium: each is used by mouse, touch and keys, on a small model.
//
//   node tools.mjs PICTURES PAGE HIERARCHY [CHECK...]
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. The hierarchy must be closed, and should have some
// partitions. The pages of examples/ that use the library's tools are used, too. Pictures go to the directory PICTURES.
// CHECK: one of the tools, cards, memory, narrow, or examples; all without any, or an eighth in a share. Exit code 2: wrong use; else see browser.mjs.
import { readFileSync, writeFileSync } from 'node:fs';
import path from 'node:path';
import { fileURLToPath } from 'node:url';
import { collectComplaints, decodePicture, frames, inChromium, inTurn, readHierarchy, until, withoutRestDetail } from './browser.mjs';
import { serve } from './server.mjs';
import { withSite } from './site.mjs';

const HERE = path.dirname(fileURLToPath(import.meta.url));
const ROOT = path.join(HERE, '../..');

const WIDE = { viewport: { width: 1000, height: 700 } };
const NARROW = { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const MIDDLE = { x: 500, y: 350 };
const CAP = [0xd9, 0x82, 0x5b]; // src/tools/caps.ts
const LEAST_TARGET = 40; // CSS pixels

class Visitor {
  constructor(browser, origin, report, { name, pictures }) {
    Object.assign(this, { browser, origin, report, name, pictures });
  }

  async open(options = WIDE) {
    const page = await this.browser.newPage({ reducedMotion: 'reduce', ...options });
    await page.addInitScript(withoutRestDetail);
    page.complaints = [];
    page.asked = [];
    page.on('request', (request) => page.asked.push(request.url().replace(`${this.origin}/`, '')));
    page.on('console', (message) => {
      if (['error', 'warning'].includes(message.type())) page.complaints.push(message.text());
    });
    page.on('pageerror', (error) => page.complaints.push(String(error)));
    await page.goto(`${this.origin}/index.html#models/${this.name}.hier`);
    await settle(page);
    return page;
  }

  async close(page, what) {
    this.check(`${what} console`, page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
    await page.close();
  }

  check(what, good, text) {
    this.report.line(`tools ${what}`, good, text);
  }

  picture(page, what) {
    return page.screenshot({ path: path.join(this.pictures, `tools-${what}.png`) });
  }
}

async function settle(page) {
  await page.waitForFunction(() => window.meshhier?.settled());
}

/// A tool of the bar is open.
async function openTool(page, tool) {
  const button = page.getByRole('button', { name: tool, exact: true });
  if (!(await button.isVisible())) await page.getByRole('button', { name: 'Tools', exact: true }).click();
  await button.click();
  await page.locator('.tool-card', { hasText: tool }).waitFor();
}

async function figuresOf(page) {
  const rows = await page.locator('.tool-figures > div').all();
  return Object.fromEntries(await Promise.all(rows.map(async (row) => [await row.locator('dt').innerText(), await row.locator('dd').innerText()])));
}

/// All digits of the numbers, as their buttons copy them.
async function copiedOf(page) {
  const rows = await page.locator('.tool-figures > div').all();
  return Object.fromEntries(await Promise.all(rows.map(async (row) => {
    const value = row.locator('.object-value');
    return [await row.locator('dt').innerText(), Number((await value.getAttribute('title')) ?? (await value.innerText()))];
  })));
}

/// A place of the window where the model is: the picture's middle sees through a ring.
async function placeOnModel(page) {
  const { width, height } = page.viewportSize();
  await page.evaluate(() => {
    const { box } = window.meshhier.view;
    const [x, y, z] = ['x', 'y', 'z'].map((axis) => (box.min[axis] + box.max[axis]) / 2);
    const far = box.max.y - box.min.y + box.max.x - box.min.x;
    const rim = box.max.x - 0.15 * (box.max.x - box.min.x);
    window.meshhier.setCamera({ position: [rim, y + 0.3 * far, z + 0.8 * far], target: [rim, y, z] });
  });
  await settle(page);
  return { x: width / 2, y: height / 2 };
}

/// Whether the page comes to show so many of them: what lies over the picture follows with its next frame.
function shows(page, selector, count) {
  return until(page, async () => (await page.locator(selector).count()) === count);
}

// ---- the tools, one after the other

async function checkPick(visitor) {
  const page = await visitor.open();
  visitor.check('loaded on use', !page.asked.some((url) => /toolbox|_tool/.test(url)), 'nothing of them at first');
  const { x, y } = await placeOnModel(page);
  await openTool(page, 'Pick a point');
  await page.mouse.click(x, y);
  await page.locator('.tool-figures', { hasText: 'the original, partition' }).waitFor();
  const free = await figuresOf(page);
  await page.locator('.surface').focus();
  await page.keyboard.press('v');
  await page.locator('.tool-note', { hasText: 'exact to the bit' }).waitFor();
  const snapped = await figuresOf(page);
  await settle(page);
  const full = await copiedOf(page);
  const isFloat = ['x', 'y', 'z'].every((axis) => Math.fround(full[axis]) === full[axis] && Math.fround(Number(snapped[axis])) === full[axis]);
  visitor.check('pick a vertex', isFloat && free.x !== snapped.x, `${snapped.x}, ${snapped.y}, ${snapped.z}`);
  const isShort = ['x', 'y', 'z'].every((axis) => free[axis].replace(/[-.]/g, '').length <= 9 && snapped[axis].replace(/[-.]/g, '').length <= 10);
  visitor.check('pick in few digits', isShort, `${free.x}, ${free.y}, ${free.z}`);
  visitor.check('pick marks it', await shows(page, '.tool-overlay circle', 1), 'one point');
  await visitor.picture(page, 'pick');
  await page.keyboard.press('Backspace');
  visitor.check('pick taken back', await shows(page, '.tool-overlay circle', 0), 'no point');
  await page.keyboard.press('Enter');
  await page.locator('.tool-figures', { hasText: 'the original, partition' }).waitFor();
  const byKey = await figuresOf(page);
  visitor.check('pick by key', byKey.x === snapped.x, 'the middle of the picture');
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  visitor.check('Escape leads out of the tools', (await until(page, async () => !(await page.locator('.tools').isVisible()))) && page.url().includes('#models'), page.url());
  await visitor.close(page, 'pick');
}

function overlap(a, b) {
  return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

/// Cards beside each other, and the way out of them.
async function checkCards(visitor) {
  const page = await visitor.open({ viewport: { width: 1280, height: 800 } });
  const figures = page.locator('.sheet-figures');
  await page.keyboard.press('s');
  await figures.waitFor();
  for (const [tool, title] of [['m', 'Measure'], ['x', 'Cut open'], ['n', 'Notes']]) {
    await page.keyboard.press(tool);
    await page.locator('.tool-card', { hasText: title }).waitFor();
    const boxes = await Promise.all([figures.boundingBox(), page.locator('.tool-card').boundingBox()]);
    visitor.check(`figures beside the card of ${tool}`, !overlap(...boxes), JSON.stringify(boxes));
  }
  const open = async () => [await page.locator('.tool-card').isVisible(), await page.locator('.tool-bar').isVisible(), await figures.isVisible()].map(Number).join('');
  const steps = [await open()];
  for (let i = 0; i < 3; ++i) {
    await page.keyboard.press('Escape');
    steps.push(await open());
  }
  const stays = page.url().includes('#models');
  visitor.check('Escape closes card, tools and figures', steps.join(' ') === '111 011 001 000' && stays, `${steps.join(' ')}, ${stays ? 'in the model' : 'out of the model'}`);
  await page.keyboard.press('Escape');
  visitor.check('then it leads out', await until(page, () => !page.url().includes('#models')), page.url());
  await visitor.close(page, 'cards');
}

async function checkMeasure(visitor) {
  const page = await visitor.open();
  const { x, y } = await placeOnModel(page);
  await page.keyboard.press('m');
  await page.locator('.tool-card', { hasText: 'Measure' }).waitFor();
  for (const up of [0, 80, 160]) await page.mouse.click(x, y - up);
  await settle(page);
  await until(page, async () => !(await page.locator('.tool-figures').innerText()).includes('±')); // points come from the original
  const figures = await figuresOf(page);
  const number = (text) => Number.parseFloat(text.replaceAll(',', ''));
  const [length, straight] = [number(figures.Length), number(figures.Straight)];
  visitor.check('measure', figures.Points === '3' && length >= straight && straight > 0, JSON.stringify(figures));
  visitor.check('measure angle and area', /^\d+\.\d\d°/.test(figures['Last angle']) && number(figures.Area) > 0 && figures['Area in plan'] !== undefined, `${figures['Last angle']}, ${figures.Area}`);
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Profile as CSV' }).click()]);
  const [head, ...rows] = readFileSync(await file.path(), 'utf8').trimEnd().split('\r\n');
  const distances = rows.map((row) => Number(row.split(',')[1]));
  const plan = (await copiedOf(page))['In plan'];
  visitor.check('measure profile', head === 'profile,distance,height,x,y,z' && rows.length > 4 && Math.min(...distances) >= 0 && Math.max(...distances) <= plan * 1.00001 && Math.max(...distances) > 0.9 * plan, `${rows.length} rows, to ${Math.max(...distances)} of ${plan}`);
  visitor.check('measure marks', (await shows(page, '.tool-overlay line', 4)) && (await shows(page, '.tool-overlay text', 2)), 'two parts');
  await page.getByLabel('The model is in').selectOption('m');
  await page.getByLabel('Show').selectOption('mm');
  const inMillimetres = await figuresOf(page);
  const ratio = number(inMillimetres.Length) / length;
  visitor.check('measure in mm', Math.abs(ratio - 1000) < 1 && inMillimetres.Length.endsWith(' mm'), inMillimetres.Length);
  await checkScale(visitor, page);
  await visitor.picture(page, 'measure');
  await visitor.close(page, 'measure');
}

/// The bar, measured with the camera: as long as it says at the target's depth.
async function checkScale(visitor, page) {
  await settle(page);
  const told = await page.evaluate(() => {
    const bar = document.querySelector('.scale-line');
    const { position, target } = window.meshhier.camera();
    const distance = Math.hypot(...position.map((value, axis) => value - target[axis]));
    const perPixel = (2 * distance * Math.tan(Math.PI / 8)) / window.innerHeight;
    return { text: bar.textContent, length: bar.getBoundingClientRect().width * perPixel * 1000 };
  });
  visitor.check('scale bar', Math.abs(told.length / Number.parseFloat(told.text) - 1) < 0.01, `${told.text} is ${told.length.toFixed(2)} mm`);
}

/// Pixels of a surface that are of the cap's colour.
async function capPixels(page, surface = '.surface') {
  const picture = await page.locator(surface).screenshot();
  return page.evaluate(async ([data, cap]) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d');
    context.drawImage(bitmap, 0, 0);
    const pixels = context.getImageData(0, 0, bitmap.width, bitmap.height).data;
    let count = 0;
    for (let i = 0; i < pixels.length; i += 4) if (cap.every((value, k) => Math.abs(pixels[i + k] - value) <= 3)) ++count;
    return count;
  }, [picture.toString('base64'), CAP]);
}

/// Closes the card of a cut, and the tools: a sign tells of the cut, and ends it.
async function checkLasting(visitor, page) {
  await page.getByRole('radio', { name: 'Plane' }).check();
  const sign = page.getByRole('button', { name: 'The model is cut open' });
  const before = await sign.isVisible();
  await page.keyboard.press('Escape');
  await page.keyboard.press('Escape');
  await sign.waitFor();
  await settle(page);
  await visitor.picture(page, 'clip-closed');
  const cut = await capPixels(page);
  await sign.click();
  await sign.waitFor({ state: 'hidden' });
  await settle(page);
  visitor.check('lasting cut', !before && cut > 2000 && (await capPixels(page)) === 0, `${cut} pixels of caps until its sign is pressed`);
}

async function checkClip(visitor) {
  const page = await visitor.open();
  const whole = await capPixels(page);
  await openTool(page, 'Cut open');
  await settle(page);
  const cut = await capPixels(page);
  visitor.check('caps', whole === 0 && cut > 2000, `${cut} pixels, ${whole} of the whole model`);
  await visitor.picture(page, 'clip-plane');
  await page.getByLabel('Caps').uncheck();
  visitor.check('no caps', (await capPixels(page)) === 0, 'the inside is seen');
  await page.getByLabel('Caps').check();
  await checkSection(visitor, page);
  await checkVolume(visitor, page);
  await page.getByRole('radio', { name: 'Box' }).check();
  for (const [side, part] of [['x to', 0.6], ['y to', 0.2]]) {
    await page.getByRole('slider', { name: side }).evaluate((one, p) => {
      one.value = String(Number(one.min) + p * (Number(one.max) - Number(one.min)));
      one.dispatchEvent(new Event('input'));
    }, part);
  }
  await settle(page);
  const boxed = await capPixels(page);
  visitor.check('box', boxed > 2000, `${boxed} pixels of caps`);
  await visitor.picture(page, 'clip-box');
  await page.getByRole('radio', { name: 'Off' }).check();
  await settle(page);
  visitor.check('off', (await capPixels(page)) === 0, 'whole again');
  await checkLasting(visitor, page);
  await visitor.close(page, 'clip');
}

/// The volume told once the view rests, and how far off it may be.
async function volumeOf(page) {
  await settle(page);
  await frames(page); // and once more drawn
  const text = await page.locator('.tool-figures dd').innerText();
  const [, , bound = '0'] = /^\(?[\d.,]+( ± ([\d.,]+))?.*³$/.exec(text);
  const { Volume: value } = await copiedOf(page);
  return { value, bound: Number(bound.replaceAll(',', '')), text };
}

/// The volumes that a plane keeps and cuts away are that of the whole.
async function checkVolume(visitor, page) {
  const kept = await volumeOf(page);
  await page.getByRole('button', { name: 'Other side' }).click();
  const away = await volumeOf(page);
  await page.getByRole('button', { name: 'Other side' }).click();
  await page.getByRole('radio', { name: 'Off' }).check();
  const whole = await volumeOf(page);
  const off = Math.abs(kept.value + away.value - whole.value);
  await page.getByRole('button', { name: 'Measure the original' }).click();
  await page.locator('.tool-note', { hasText: 'The volume of the original mesh.' }).waitFor();
  const original = await volumeOf(page);
  visitor.check('volume of the original', original.bound === 0 && Math.abs(original.value - whole.value) <= whole.bound, original.text);
  visitor.check('volume', kept.value > 0 && away.value > 0 && off <= kept.bound + away.bound + whole.bound + 1e-5 * whole.value, `${kept.text} and ${away.text} of ${whole.text}`);
  await page.getByRole('radio', { name: 'Plane' }).check();
  await settle(page);
}

/// The section through the ring's middle has closed lines, as wide and high as the model is there.
async function checkSection(visitor, page) {
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Section as SVG' }).click()]);
  const svg = readFileSync(await file.path(), 'utf8');
  const paths = [...svg.matchAll(/ d="([^"]*)"/g)].map((match) => match[1]);
  const [width, height] = /viewBox="0 0 (\S+) (\S+)"/.exec(svg).slice(1).map(Number);
  const isGood = paths.length > 0 && paths.every((path) => /^M[^M]*Z$/.test(path)) && width > 0 && height > 0;
  visitor.check('section', isGood, `${paths.length} closed lines, ${width.toFixed(3)} x ${height.toFixed(3)}, ${file.suggestedFilename()}`);
}

async function checkNotes(visitor) {
  const page = await visitor.open();
  const { x, y } = await placeOnModel(page);
  await page.keyboard.press('n');
  await page.locator('.tool-card', { hasText: 'Notes' }).waitFor();
  await page.mouse.click(x, y);
  await page.locator('.tool-list textarea').fill('a <b>crack</b>');
  await page.locator('.tool-list textarea').press('Control+Enter');
  await page.waitForFunction(() => location.hash.includes('notes='));
  await settle(page);
  visitor.check('note', (await page.locator('.tool-overlay text').innerHTML()) === 'a &lt;b&gt;crack&lt;/b&gt;', 'its text at its point');
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save as a file' }).click()]);
  const saved = JSON.parse(readFileSync(await file.path(), 'utf8'));
  const [note] = saved.items;
  visitor.check('notes saved', saved.items.length === 1 && note.body[0].value === 'a <b>crack</b>' && Number.isFinite(note.target.selector[0].x), JSON.stringify(note));
  await page.waitForTimeout(500); // the camera has come to rest
  await page.reload();
  await page.locator('.tool-overlay text', { hasText: 'crack' }).waitFor();
  visitor.check('notes in the link', true, `${page.url().length} letters`);
  await page.evaluate(() => { location.hash = location.hash.replace(/&notes=[^&]*/, ''); });
  await page.locator('.tool-overlay text').waitFor({ state: 'detached' });
  await page.goBack();
  await page.locator('.tool-overlay text', { hasText: 'crack' }).waitFor();
  visitor.check('notes of another link', true, 'the address tells');
  await page.getByRole('button', { name: 'Share' }).click();
  const link = await page.getByLabel('Link to this view').inputValue();
  visitor.check('notes are shared', link === page.url() && link.includes('notes='), link);
  await page.keyboard.press('Escape');
  await page.locator('.tool-file').setInputFiles({ name: 'bad.json', mimeType: 'application/json', buffer: Buffer.from('{"notes": 1}') });
  await page.locator('.tool-note', { hasText: 'bad.json' }).waitFor();
  await page.locator('.tool-file').setInputFiles(await file.path());
  await page.locator('.tool-list li').nth(1).waitFor();
  await page.getByRole('button', { name: 'Go to Note 2' }).click();
  await settle(page);
  await page.getByRole('button', { name: 'Remove Note 2' }).click();
  await page.getByRole('button', { name: 'Remove Note 1' }).click();
  await page.waitForFunction(() => !location.hash.includes('notes='));
  visitor.check('notes loaded and removed', await shows(page, '.tool-list li', 0), 'none is left');
  await visitor.picture(page, 'notes');
  await visitor.close(page, 'notes');
}

async function checkCamera(visitor) {
  const page = await visitor.open();
  await openTool(page, 'Camera and pictures');
  await page.locator('.surface').focus();
  await page.keyboard.press('b');
  const before = await page.evaluate(() => window.meshhier.camera());
  await page.getByRole('button', { name: 'Look from top' }).dispatchEvent('click');
  await settle(page);
  const above = await page.evaluate(() => window.meshhier.camera());
  visitor.check('cube', above.position[1] - above.target[1] > 0.99 * Math.hypot(...above.position.map((value, axis) => value - above.target[axis])), 'from the top');
  await visitor.picture(page, 'camera');
  await page.getByRole('button', { name: 'Go to View 1' }).click();
  await settle(page);
  const again = await page.evaluate(() => window.meshhier.camera());
  visitor.check('bookmark', JSON.stringify(again) === JSON.stringify(before), 'the same camera');
  await page.keyboard.press('r');
  await settle(page);
  const stepped = await page.evaluate(() => window.meshhier.camera());
  await page.waitForTimeout(300);
  const rests = await page.evaluate(() => window.meshhier.camera());
  visitor.check('turntable with less motion', JSON.stringify(stepped) !== JSON.stringify(again) && JSON.stringify(stepped) === JSON.stringify(rests), 'a step, and rest');
  await checkShot(visitor, page);
  await visitor.close(page, 'camera');
  const moving = await visitor.open({ ...WIDE, reducedMotion: 'no-preference' });
  await openTool(moving, 'Camera and pictures');
  await moving.locator('.surface').focus();
  await moving.keyboard.press('r');
  const positionOf = () => moving.evaluate(() => window.meshhier.camera().position.join());
  const turned = async () => moving.waitForFunction((before) => window.meshhier.camera().position.join() !== before, await positionOf());
  for (let i = 0; i < 3; ++i) await turned();
  await moving.keyboard.press('Escape');
  await moving.keyboard.press('Escape'); // the tools are closed: it goes on
  await turned();
  await moving.mouse.click(MIDDLE.x, MIDDLE.y);
  await settle(moving);
  const stands = await positionOf();
  await moving.waitForTimeout(300);
  visitor.check('turntable', (await positionOf()) === stands, 'turns until it is touched');
  await visitor.close(moving, 'turntable');
}

/// Larger than the window and than a part of it is drawn at once.
async function checkShot(visitor, page) {
  await page.getByLabel('Width, pixels').fill('1500');
  await page.getByLabel('Height, pixels').fill('1100');
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save a picture' }).click()]);
  const bytes = readFileSync(await file.path());
  writeFileSync(path.join(visitor.pictures, 'tools-shot.png'), bytes);
  const { width, height, seam, covered } = await page.evaluate(async (data) => {
    const bitmap = await createImageBitmap(await (await fetch(`data:image/png;base64,${data}`)).blob());
    const context = new OffscreenCanvas(bitmap.width, bitmap.height).getContext('2d', { willReadFrequently: true });
    context.drawImage(bitmap, 0, 0);
    const brightness = (x, y) => context.getImageData(x, y, 1, 1).data.slice(0, 3).reduce((a, b) => a + b, 0);
    const rows = Array.from({ length: 100 }, (_, i) => Math.floor((i * bitmap.height) / 100));
    const step = (x) => rows.reduce((sum, y) => sum + Math.abs(brightness(x, y) - brightness(x + 1, y)), 0) / rows.length;
    return { width: bitmap.width, height: bitmap.height, seam: step(1023) / Math.max(3, step(1010), step(1040)), covered: rows.filter((y) => brightness(750, y) < 740).length };
  }, bytes.toString('base64'));
  visitor.check('picture', width === 1500 && height === 1100 && seam < 3 && covered > 10, `${width} x ${height}, ${covered} % of a column covered, seam ${seam.toFixed(2)}`);
  await settle(page);
  visitor.check('picture leaves the page as it was', (await page.evaluate(() => document.querySelector('canvas').width)) === WIDE.viewport.width, 'the canvas has its size');
}

/// Each tool, over and over: what is kept of it does not grow.
async function checkMemory(visitor) {
  const page = await visitor.open();
  const { x, y } = await placeOnModel(page);
  const round = async () => {
    for (const key of ['i', 'm', 'x', 'n', 'k']) {
      await page.keyboard.press(key);
      await page.locator('.tool-card').waitFor();
      if (key === 'i' || key === 'm') for (const aside of [0, 20]) await page.mouse.click(x, y - aside);
      await settle(page);
      await page.locator('.surface').focus();
      for (let back = 0; key === 'm' && back < 2; ++back) await page.keyboard.press('Backspace');
      await page.keyboard.press('Escape');
    }
  };
  const used = () => page.evaluate(() => {
    window.gc();
    return performance.memory.usedJSHeapSize;
  });
  for (let i = 0; i < 3; ++i) await round();
  const before = await used();
  for (let i = 0; i < 6; ++i) await round();
  const after = await used();
  visitor.check('memory', after - before < 2e6, `${((after - before) / 1e6).toFixed(2)} MB more after six rounds`);
  await visitor.close(page, 'memory');
}

async function checkNarrow(visitor) {
  const page = await visitor.open(NARROW);
  const { x, y } = await placeOnModel(page);
  await page.getByRole('button', { name: 'Tools', exact: true }).tap();
  await page.getByRole('button', { name: 'Pick a point', exact: true }).tap();
  await page.locator('.tool-card').waitFor();
  await page.touchscreen.tap(x, y - 60);
  await page.locator('.tool-figures', { hasText: 'the original, partition' }).waitFor();
  const small = await page.evaluate((least) => [...document.querySelectorAll('.tools button, .tools label.check, .tools select')]
    .filter((one) => one.checkVisibility() && !one.closest('[hidden], .cube')) // a cube's faces are as they are turned
    .filter((one) => { const { width, height } = one.getBoundingClientRect(); return width < least || height < least; })
    .map((one) => one.getAttribute('aria-label') ?? one.textContent), LEAST_TARGET);
  visitor.check('by touch', small.length === 0, small.join(', ') || 'a point, and targets of 40 pixels');
  await visitor.picture(page, 'narrow');
  await visitor.close(page, 'narrow');
}

// ---- the same with the library alone

/// A page of examples/, with what its console complained of.
async function openExample(browser, { origin }, example) {
  const page = await browser.newPage(WIDE);
  page.complaints = [];
  collectComplaints(page, page.complaints, ['error', 'warning']);
  await page.goto(`${origin}/examples/${example}.html?url=/hierarchy`);
  return page;
}

async function checkPickExample(visitor, server) {
  const page = await openExample(visitor.browser, server, 'pick');
  const told = page.locator('#told');
  await page.keyboard.down('Shift');
  for (let count = 1; count <= 2; ++count) {
    await clickModel(page, { x: MIDDLE.x + 150 * count, y: MIDDLE.y }, () => told.innerText().then((text) => text.includes(`${count} points`)));
  }
  visitor.check('example pick', page.complaints.length === 0 && (await told.innerText()).includes("the input's own numbers"), [await told.innerText(), ...page.complaints].join('; ').replaceAll('\n', ' '));
  await page.close();
}

async function checkSectionExample(visitor, server) {
  const page = await openExample(visitor.browser, server, 'section');
  if (!(await until(page, async () => (await capPixels(page, 'canvas')) >= 2000))) throw new Error('the example shows no cap');
  const [file] = await Promise.all([page.waitForEvent('download'), page.mouse.click(MIDDLE.x, MIDDLE.y)]);
  const paths = [...readFileSync(await file.path(), 'utf8').matchAll(/ d="M[^"]*Z"/g)];
  await visitor.picture(page, 'example-section');
  visitor.check('example section', paths.length > 0 && page.complaints.length === 0, `${paths.length} closed lines ${page.complaints.join('; ')}`);
  await page.close();
}

async function checkPictureExample(visitor, server) {
  const page = await openExample(visitor.browser, server, 'picture');
  await page.locator('canvas').waitFor();
  await page.locator('#message').waitFor({ state: 'hidden' });
  await page.waitForTimeout(1000); // it turns
  const [file] = await Promise.all([page.waitForEvent('download'), page.mouse.click(MIDDLE.x, MIDDLE.y)]);
  const bytes = readFileSync(await file.path());
  const [width, height] = [bytes.readUInt32BE(16), bytes.readUInt32BE(20)];
  visitor.check('example picture', width === 6000 && height === 4000 && page.complaints.length === 0, `${width} x ${height}, ${bytes.length} bytes ${page.complaints.join('; ')}`);
  await page.close();
}

/// A plug-in of somebody else, and some of the library's, in the element.
async function checkPluginExample(visitor, server) {
  const page = await openExample(visitor.browser, server, 'plugin');
  await page.waitForFunction(() => document.querySelector('meshhier-viewer').view?.stats().settled);
  const shot = () => page.screenshot({ clip: { x: 250, y: 200, width: 500, height: 300 } }); // without the button
  const lined = await shot();
  await page.getByRole('button', { name: 'Contours' }).click();
  const isBare = await until(page, async () => !lined.equals(await shot()));
  await visitor.picture(page, 'example-plugin');
  visitor.check('example plugin', isBare, 'its button takes its lines away');
  const texts = page.locator('.meshhier-overlay text');
  for (let count = 1; count <= 2; ++count) {
    await clickModel(page, { x: MIDDLE.x + 150 * count, y: MIDDLE.y }, async () => (await page.locator('.meshhier-overlay circle').count()) === count);
  }
  visitor.check('example measuring', /^[\d.]+.* units$/.test(await texts.first().innerHTML()), await texts.first().innerHTML());
  const names = await page.evaluate(() => ['contours', 'measuring', 'relief', 'attributes'].filter((name) => document.querySelector('meshhier-viewer').view.plugins.named(name)));
  visitor.check('example plugins', names.length === 4 && page.complaints.length === 0, [...names, ...page.complaints].join(', '));
  await checkFailingPlugin(visitor, page);
  await page.evaluate(() => { document.querySelector('meshhier-viewer').remove(); });
  visitor.check('example plugin is gone', (await page.getByRole('button', { name: 'Contours' }).count()) === 0, 'with its element');
  await page.close();
}

/// One that cannot be made is told, now and when the model is opened anew; the others come, on a canvas that is on the page.
async function checkFailingPlugin(visitor, page) {
  await page.evaluate(() => {
    const viewer = document.querySelector('meshhier-viewer');
    window.toldOfPlugins = [];
    viewer.addEventListener('problem', ({ detail }) => window.toldOfPlugins.push(detail.message));
    viewer.registerPlugin(() => { throw new Error('no plug-in'); });
    viewer.registerPlugin(() => ({ name: 'late', enter: ({ surface }) => window.toldOfPlugins.push(`${surface.role} ${surface.isConnected}`) }));
    viewer.replaceWith(viewer);
  });
  await page.waitForFunction(() => window.toldOfPlugins.length >= 4);
  const told = await page.evaluate(() => [...window.toldOfPlugins, document.querySelector('meshhier-viewer').view.plugins.named('contours')?.name].join(', '));
  visitor.check('element without a plug-in', told === 'no plug-in, application true, no plug-in, application true, contours', told);
}

/// Of a row of the picture the outermost place, from the right, that the model covers with all around it; null: there is none.
function coveredPlace(pixels, from, y) {
  const { width, height } = WIDE.viewport;
  const colourAt = (x, row) => pixels.subarray(4 * (row * width + x), 4 * (row * width + x) + 3);
  const ground = colourAt(0, height - 1);
  const isCovered = (x, row) => colourAt(x, row).some((value, k) => Math.abs(value - ground[k]) > 20);
  const around = [-8, 0, 8];
  for (let x = from; x > MIDDLE.x; x -= 5) if (around.every((right) => around.every((down) => isCovered(x + right, y + down)))) return { x, y };
  return null;
}

/// Clicks the model near a place of its row, once it is seen there; what comes of it is enough.
async function clickModel(page, { x, y }, isEnough) {
  let place = null;
  await until(page, async () => {
    place = coveredPlace(await decodePicture(page, await page.screenshot()), x, y);
    return place !== null;
  });
  await page.mouse.click(place.x, place.y);
  if (!(await until(page, isEnough))) throw new Error('nothing was picked');
}

async function checkExamples(visitor, directory) {
  const server = await serve({
    '/examples/node_modules/meshoptimizer': path.join(ROOT, 'viewer/node_modules/meshoptimizer'),
    '/examples/node_modules': path.join(HERE, 'node_modules'),
    '/examples': path.join(ROOT, 'examples'),
    '/viewer/dist': path.join(ROOT, 'viewer/dist'),
    '/hierarchy': directory,
  });
  await checkPickExample(visitor, server);
  await checkSectionExample(visitor, server);
  await checkPictureExample(visitor, server);
  await checkPluginExample(visitor, server);
  server.close();
}

const CHECKS = {
  pick: checkPick, cards: checkCards, measure: checkMeasure, clip: checkClip, notes: checkNotes, camera: checkCamera, memory: checkMemory, narrow: checkNarrow, examples: checkExamples,
};

async function checkAll(browser, report, { pictures, hierarchy, origin, checks }) {
  const visitor = new Visitor(browser, origin, report, { name: hierarchy.name, pictures });
  for (const check of checks) await CHECKS[check](visitor, hierarchy.directory);
}

async function serveAndCheck(browser, report, [pictures, page, directory, ...checks]) {
  const hierarchy = readHierarchy(directory);
  await withSite(page, [hierarchy], (origin) => checkAll(browser, report, { pictures, hierarchy, origin, checks: checks.length > 0 ? checks : inTurn(Object.keys(CHECKS)) }));
}

const [pictures, ...others] = process.argv.slice(2);
if (others.length < 2 || !others.slice(2).every((check) => check in CHECKS)) {
  console.log('usage: node tools.mjs PICTURES PAGE HIERARCHY [CHECK...]');
  process.exit(2);
}
process.exit(await inChromium(pictures, (browser, report) => serveAndCheck(browser, report, [pictures, ...others])));

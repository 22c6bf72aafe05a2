// A story of a model, as `meshhier serve` and `meshhier page` show it, in headless Chromium: an author writes notes with views, a picture and
// a link, saves them and puts the file beside the hierarchy; a visitor follows a plain link and is told the story, read only.
//
//   node stories.mjs MESHHIER PICTURES PAGE HIERARCHY.hier
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page. Pictures go to the directory PICTURES. Exit code 2: wrong use;
// else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { createServer } from 'node:http';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { pathToFileURL } from 'node:url';
import { collectComplaints, inChromium, PATIENCE, until, withoutRestDetail } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';

const SOON = 500;
const WIDE = { viewport: { width: 1280, height: 800 } };
const PHONE = { viewport: { width: 360, height: 640 }, deviceScaleFactor: 2, hasTouch: true, isMobile: true };
const MODEL = 'told';
const LONG = 'The second note.\nIt has two lines and <b>no marks</b>.';

class Visit {
  constructor(browser, report, pictures) {
    Object.assign(this, { browser, report, pictures });
  }

  async open(url, options = WIDE, { still = true } = {}) {
    const page = await this.browser.newPage({ reducedMotion: still ? 'reduce' : 'no-preference', ...options });
    if (!still) await page.addInitScript(withoutLongFrames);
    await page.addInitScript(withoutRestDetail);
    page.complaints = [];
    collectComplaints(page, page.complaints, ['error', 'warning']);
    await page.goto(url);
    await settle(page);
    return page;
  }

  check(what, good, text) {
    this.report.line(`stories ${what}`, good, text);
  }

  picture(page, what) {
    return page.screenshot({ path: path.join(this.pictures, `stories-${what}.png`) });
  }

  async close(page, what) {
    this.check(`${what} console`, page.complaints.length === 0, page.complaints.join('; ') || 'no complaints');
    await page.close();
  }
}

async function settle(page) {
  await page.waitForFunction(() => window.meshhier?.settled());
}

function cameraOf(page) {
  return page.evaluate(() => window.meshhier.camera());
}

function distance(a, b) {
  return Math.hypot(...a.position.map((value, axis) => value - b.position[axis])) / Math.hypot(...a.position.map((value, axis) => value - a.target[axis]));
}

async function lookFrom(page, change) {
  await page.evaluate((by) => {
    const { position, target } = window.meshhier.camera();
    const size = Math.hypot(...position.map((value, axis) => value - target[axis]));
    window.meshhier.setCamera({ position: position.map((value, axis) => value + by[axis] * size), target });
  }, change);
  await settle(page);
}

async function pointSomething(page) {
  const count = await page.locator('.tool-list li').count();
  for (const [right, up] of [[0, 0], [-60, 30], [60, 30], [0, 80], [-100, 60], [100, 60]]) {
    await page.mouse.click(640 + right, 400 + up);
    if ((await page.locator('.tool-list li').count()) > count) return;
  }
  throw new Error('nothing was pointed at');
}

/// As people type: Enter begins a line, Ctrl + Enter ends the text.
async function write(page, i, text) {
  const field = page.locator('.tool-list textarea').nth(i);
  await field.fill('');
  for (const [number, line] of text.split('\n').entries()) {
    if (number > 0) await field.press('Enter');
    await field.pressSequentially(line);
  }
  await field.press('Control+Enter');
}

/// Keys that are typed into fields reach neither the view nor the tools, and Escape leaves the field alone.
async function typeKeys(visit, page) {
  const state = () => page.evaluate(() => JSON.stringify([window.meshhier.camera(), window.meshhier.view.look, location.hash, [...document.querySelectorAll('.sheet, .tool-card')].map(({ hidden }) => hidden)]));
  let before = await state();
  await until(page, async () => { // points come from the original, and with them the address
    const last = before;
    await page.waitForTimeout(SOON);
    before = await state();
    return before === last;
  });
  for (const field of [page.getByLabel('Title'), page.locator('.tool-list textarea').first()]) {
    const text = await field.inputValue();
    await field.focus();
    for (const key of [...'wtpofslgca?h0123456+-imxnkvbre', 'ArrowLeft', 'ArrowUp', 'Home', 'Backspace', 'Enter']) await field.press(key);
    await field.fill(text);
    await field.press('Escape');
    visit.check('typing', (await state()) === before && (await page.evaluate(() => document.activeElement === document.body)), 'leaves view and tools as they are; Escape leaves the field');
  }
}

/// Two notes, the second with all that a note has; the story's file and the camera of the second one.
async function author(visit, url) {
  const page = await visit.open(url);
  await page.keyboard.press('n');
  await page.locator('.tool-card', { hasText: 'Notes' }).waitFor();
  await pointSomething(page);
  await write(page, 0, 'The first note');
  await lookFrom(page, [0.4, 0.2, 0]);
  await pointSomething(page);
  await write(page, 1, LONG);
  await typeKeys(visit, page);
  const row = page.locator('.tool-list li').nth(1);
  await row.locator('summary').click();
  await page.keyboard.press('Escape'); // a field has the focus no more
  await page.keyboard.press('n');
  await page.evaluate(() => document.querySelector('.surface').focus());
  await page.keyboard.press('w');
  await settle(page);
  await row.getByRole('button', { name: 'Keep this view' }).click();
  const seen = await cameraOf(page);
  await row.locator('.note-file').setInputFiles({ name: 'far.png', mimeType: 'image/png', buffer: await pictureOf(page) });
  await row.getByRole('button', { name: 'Remove the picture' }).waitFor();
  await row.locator('input[type=url]').fill('https://example.org/more?a=1');
  await row.locator('input[type=url]').press('Tab');
  await page.locator('.tool-note', { hasText: 'save the notes as a file' }).waitFor();
  visit.check('link without pictures', !page.url().includes('notes='), page.url());
  await page.getByLabel('Title').fill('Two places');
  await page.getByLabel('Title').press('Tab');
  await visit.picture(page, 'author');
  await page.getByRole('button', { name: 'Show as a story' }).click();
  await page.locator('.story-text', { hasText: 'The first note' }).waitFor();
  await page.locator('.story-card').getByRole('button', { name: 'Close story' }).click();
  await page.locator('.story-card').waitFor({ state: 'detached' });
  await row.getByRole('button', { name: 'Note 2: earlier' }).click();
  await page.waitForFunction(() => document.querySelector('.tool-list textarea').value.startsWith('The second'));
  await page.locator('.tool-list li').first().getByRole('button', { name: 'Note 1: later' }).click();
  const [file] = await Promise.all([page.waitForEvent('download'), page.getByRole('button', { name: 'Save as a file' }).click()]);
  const text = readFileSync(await file.path(), 'utf8');
  visit.check('file', file.suggestedFilename() === `${MODEL}.hier.story.json`, file.suggestedFilename());
  await visit.close(page, 'author');
  return { text, seen };
}

/// Larger than a note keeps it.
async function pictureOf(page) {
  const data = await page.evaluate(() => {
    const canvas = document.createElement('canvas');
    [canvas.width, canvas.height] = [2000, 1000];
    canvas.getContext('2d').fillStyle = '#c02020';
    canvas.getContext('2d').fillRect(0, 0, 2000, 1000);
    return canvas.toDataURL('image/png').split(',')[1];
  });
  return Buffer.from(data, 'base64');
}

function checkFile(visit, text) {
  const story = JSON.parse(text);
  const kinds = story.items.map(({ motivation }) => motivation.join());
  const [first, camera, second] = story.items;
  const picture = second.body.find(({ type }) => type === 'Image').id;
  const isGood = story.type === 'AnnotationPage' && story.label.none[0] === 'Two places' && kinds.join(' ') === 'commenting painting commenting' &&
    first.target.selector[0].type === 'PointSelector' && camera.body.type === 'PerspectiveCamera' && second.target.scope[0].target.id === camera.id &&
    second.body[0].value === LONG && picture.startsWith('data:image/webp;base64,') && camera.body['meshhier:choices'].includes('wires=on');
  visit.check('annotations', isGood, `${text.length} bytes: ${kinds.join(', ')}; ${camera.body['meshhier:choices']}`);
}

/// From a plain link: the story is there, and goes from note to note.
async function visitor(visit, url, seen) {
  const page = await visit.open(url);
  const card = page.locator('.story-card');
  await card.waitFor();
  visit.check('offered', (await card.innerText()).includes('Two places') && (await card.innerText()).includes('2 notes') && (await page.locator('.story-mark').count()) === 2, (await card.innerText()).replace(/\n/g, ' '));
  await visit.picture(page, 'offered');
  const before = await page.evaluate(() => window.meshhier.view.look.wires);
  await card.getByRole('button', { name: 'Next note' }).click();
  await page.locator('.story-text', { hasText: 'The first note' }).waitFor();
  await card.getByRole('button', { name: 'Next note' }).click();
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  await settle(page);
  const camera = await cameraOf(page);
  const wires = await page.evaluate(() => window.meshhier.view.look.wires);
  visit.check('view', distance(camera, seen) < 1e-9 && wires && !before, `${distance(camera, seen)} of the distance off, wires ${before} to ${wires}`);
  const image = await page.locator('.story-picture').evaluate((picture) => picture.decode().then(() => [picture.naturalWidth, picture.naturalHeight]));
  visit.check('picture', image.join() === '1280,640', `${image.join(' x ')}`);
  const link = await page.locator('.story-link').evaluate(({ href, rel, target, innerText }) => ({ href, rel, target, innerText }));
  visit.check('way on', link.href === 'https://example.org/more?a=1' && link.rel.includes('noopener') && link.innerText.includes('example.org'), JSON.stringify(link));
  visit.check('text', (await page.locator('.story-text').innerHTML()) === 'The second note.\nIt has two lines and &lt;b&gt;no marks&lt;/b&gt;.', 'as it was written');
  visit.check('read only', (await page.locator('.story-card input, .story-card textarea').count()) === 0 && (await card.getByRole('button', { name: 'Next note' }).isDisabled()), 'nothing to write in, no note behind the last');
  await page.waitForFunction(() => location.hash.includes('story=2'));
  await visit.picture(page, 'second');
  const shared = page.url();
  await page.locator('.story-mark').first().press('Enter');
  await page.locator('.story-text', { hasText: 'The first note' }).waitFor();
  visit.check('marks', (await page.locator('.story-mark[aria-current=step]').innerText()) === '1', 'a click on one tells it');
  await page.evaluate(() => document.querySelector('.surface').focus());
  await page.keyboard.press('Escape');
  await card.waitFor({ state: 'detached' });
  await page.waitForFunction(() => !location.hash.includes('story='));
  visit.check('closed', !(await page.evaluate(() => window.meshhier.view.look.wires)), 'Escape: as it was before');
  await page.getByRole('button', { name: 'Story' }).click();
  await card.waitFor();
  await visit.close(page, 'visitor');
  return shared;
}

/// The link that a visitor shared at the second note.
async function shared(visit, url, seen) {
  const page = await visit.open(url);
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  visit.check('shared', distance(await cameraOf(page), seen) < 1e-9, 'the note that was told, and the camera where it was');
  await visit.close(page, 'shared');
}

/// To run in a page before its scripts: for what moves, a frame takes 50 milliseconds at the most. No flight is over after a frame or two.
function withoutLongFrames() {
  const request = window.requestAnimationFrame.bind(window);
  const clock = { now: 0, last: 0 };
  window.requestAnimationFrame = (callback) => request((now) => {
    clock.now += Math.min(now - clock.last, 50);
    clock.last = now;
    callback(clock.now);
  });
}

/// Notes the camera's places from now on, in `window.places`.
function recordPlaces(page) {
  return page.evaluate(() => {
    window.places = new Set();
    const record = () => {
      window.places.add(window.meshhier.camera().position.join());
      requestAnimationFrame(record);
    };
    record();
  });
}

/// It goes on by itself, smoothly, and stops when the visitor takes the camera.
async function playing(visit, url) {
  const page = await visit.open(url, WIDE, { still: false });
  await recordPlaces(page);
  await page.locator('.story-card').getByRole('button', { name: 'Play' }).click();
  await page.locator('.story-text', { hasText: 'The first note' }).waitFor();
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  await settle(page);
  const places = await page.evaluate(() => window.places.size);
  visit.check('flight', places > 4, `${places} places of the camera: three where it rests, and some on the way`);
  await page.mouse.move(700, 300);
  await page.mouse.down();
  await page.locator('.story-card').getByRole('button', { name: 'Play' }).waitFor();
  await page.mouse.up();
  visit.check('playing', true, 'from note to note, until the camera is taken');
  await visit.close(page, 'playing');
}

async function phone(visit, url) {
  const page = await visit.open(url, PHONE);
  const card = page.locator('.story-card');
  await card.getByRole('button', { name: 'Next note' }).tap();
  await card.getByRole('button', { name: 'Next note' }).tap();
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  const box = await card.boundingBox();
  const targets = await card.getByRole('button').evaluateAll((buttons) => buttons.map((button) => Math.min(button.offsetWidth, button.offsetHeight)));
  visit.check('phone', box.x >= 0 && box.x + box.width <= 360 && box.y >= 640 * 0.5 && box.y + box.height <= 640 && Math.min(...targets) >= 40, `${JSON.stringify(box)}, targets from ${Math.min(...targets)}`);
  await visit.picture(page, 'phone');
  await visit.close(page, 'phone');
}

/// Whatever a story's file holds, the model is shown, and the page says what is wrong.
async function damaged(visit, url, file, good) {
  for (const [what, text, said] of [['no JSON', '{', 'not JSON'], ['another file', '{"type": "Collection"}', 'AnnotationPage'], ['no number', good.replace(/"x": [-0-9.e]+/, '"x": "1"'), 'is not a number']]) {
    writeFileSync(file, text);
    const page = await visit.open(url);
    await page.locator('.problem', { hasText: 'story' }).waitFor();
    await page.locator('.problem summary').click();
    const why = await page.locator('.problem-more').innerText();
    visit.check(`damaged: ${what}`, why.includes(said) && (await page.locator('.story-card').count()) === 0, why);
    await page.close();
  }
  const hostile = JSON.parse(good);
  hostile.items[2].body.find(({ type }) => type === 'Image').id = 'javascript:window.hacked=1';
  hostile.items[2].body.find(({ purpose }) => purpose === 'linking').id = 'javascript:window.hacked=1';
  writeFileSync(file, JSON.stringify(hostile));
  const page = await visit.open(`${url}&story=2`);
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  visit.check('hostile addresses', (await page.locator('.story-card img, .story-card a').count()) === 0, 'are left out');
  await visit.close(page, 'hostile');
  writeFileSync(file, good);
}

async function single(visit, meshhier, { models, viewer, work }) {
  const file = path.join(work, 'single.html');
  execFileSync(meshhier, ['page', path.join(models, `${MODEL}.hier`), '-o', file, '--viewer', viewer]);
  const context = await visit.browser.newContext({ reducedMotion: 'reduce', ...WIDE });
  await context.setOffline(true);
  const page = await context.newPage();
  await page.goto(pathToFileURL(file).href);
  await settle(page);
  await page.locator('.story-card').getByRole('button', { name: 'Next note' }).click();
  await page.locator('.story-text', { hasText: 'The first note' }).waitFor();
  visit.check('one file', true, 'tells it from the disk, offline');
  await context.close();
  await fetchesNothing(visit, file);
}

/// Whatever its story names: a picture of another host is left out, and nobody is asked for it.
async function fetchesNothing(visit, file) {
  const asked = [];
  const other = createServer((request, response) => {
    asked.push(request.url);
    response.end();
  });
  await new Promise((resolve) => { other.listen(0, '127.0.0.1', resolve); });
  const spy = `http://127.0.0.1:${other.address().port}/spy.webp`;
  const text = readFileSync(file, 'utf8').replace(/data:image\/webp;base64,[A-Za-z0-9+/=]+/, spy);
  writeFileSync(file, text);
  const page = await visit.browser.newPage({ reducedMotion: 'reduce', ...WIDE });
  await page.goto(`${pathToFileURL(file).href}#&story=2`);
  await settle(page);
  await page.locator('.story-text', { hasText: 'no marks' }).waitFor();
  await page.evaluate((url) => new Promise((done) => { // the page's policy holds for whatever it is told
    const picture = new Image();
    picture.onload = picture.onerror = done;
    picture.src = url;
  }).then(() => undefined), spy);
  visit.check('one file asks nobody', text.includes(spy) && asked.length === 0 && (await page.locator('.story-picture').count()) === 0, asked.join(', ') || 'no request');
  await page.close();
  other.close();
}

async function site(visit, meshhier, { models, viewer, work }) {
  const folder = path.join(work, 'site');
  execFileSync(meshhier, ['page', models, '-o', folder, '--viewer', viewer]);
  const server = await serve({ '': folder });
  const page = await visit.open(`${server.origin}/index.html#models/${MODEL}.hier`);
  await page.locator('.story-card', { hasText: 'Two places' }).waitFor();
  visit.check('a plain host', true, 'tells it, too');
  await visit.close(page, 'a plain host');
  const alone = await visit.open(`${server.origin}/index.html?model=models/${MODEL}.hier&story=models/${MODEL}.hier.story.json`);
  await alone.locator('.story-card', { hasText: 'Two places' }).waitFor();
  visit.check('without a listing', true, 'the address names it');
  await visit.close(alone, 'without a listing');
  server.close();
}

/// The server looks at the folder once a second.
async function isListed(url, file) {
  for (const end = Date.now() + PATIENCE; Date.now() < end && !(await (await fetch(new URL('models.json', url))).text()).includes(file); ) await new Promise((resolve) => { setTimeout(resolve, 50); });
}

async function checkAll(browser, report, [meshhier, pictures, viewer, hierarchy]) {
  const visit = new Visit(browser, report, pictures);
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-stories-'));
  const models = path.join(work, 'models');
  mkdirSync(models);
  cpSync(hierarchy, path.join(models, `${MODEL}.hier`), { recursive: true });
  const server = startServer(meshhier, models, '--viewer', viewer);
  try {
    const url = `${await server.url}#models/${MODEL}.hier`;
    const { text, seen } = await author(visit, url);
    checkFile(visit, text);
    const file = path.join(models, `${MODEL}.hier.story.json`);
    writeFileSync(file, text);
    await isListed(await server.url, `${MODEL}.hier.story.json`);
    const link = await visitor(visit, url, seen);
    await shared(visit, link, seen);
    await playing(visit, url);
    await phone(visit, url);
    await single(visit, meshhier, { models, viewer, work });
    await site(visit, meshhier, { models, viewer, work });
    await damaged(visit, url, file, text);
  } finally {
    await server.stop();
    rmSync(work, { recursive: true });
  }
}

const given = process.argv.slice(2);
if (given.length !== 4) {
  console.log('usage: node stories.mjs MESHHIER PICTURES PAGE HIERARCHY.hier');
  process.exit(2);
}
process.exit(await inChromium(given[1], (browser, report) => checkAll(browser, report, given)));

// Each kind of address that the program or a document offers, in headless Chromium: it shows what it names, without a message. Of the documents
// all addresses are taken as they stand there, so that a new one is opened, too.
//
//   node addresses.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz
//
// PAGE: the directory that `npm run build` of viewer/ makes, dist/page; HIERARCHY.hier: with tiles in gzip. Exit code 2: wrong use; else see browser.mjs.
import { execFileSync } from 'node:child_process';
import { cpSync, mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from 'node:fs';
import { tmpdir } from 'node:os';
import path from 'node:path';
import { fileURLToPath, pathToFileURL } from 'node:url';
import { collectComplaints, inChromium, withoutRestDetail } from './browser.mjs';
import { startServer } from './meshhier_server.mjs';
import { serve } from './server.mjs';

const WINDOW = { viewport: { width: 800, height: 600 }, reducedMotion: 'reduce' };
const ROOT = path.join(path.dirname(fileURLToPath(import.meta.url)), '../..');
const DOCUMENTS = ['docs/serving.md', 'docs/command_line.md', 'docs/troubleshooting.md', 'viewer/README.md', 'README.md', 'viewer/page/words/en.ts'];
const LEAST_FOUND = 8; // addresses in the documents: fewer, and they are not found
const HOST_PAGE = 'host.html';
const PIXEL = Buffer.from('iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP4z8DwHwAFAAH/iZk9HQAAAABJRU5ErkJggg==', 'base64');
const STORY = {
  type: 'AnnotationPage',
  label: { none: ['A tour'] },
  items: [{ id: 'n', type: 'Annotation', motivation: ['commenting'], body: [{ type: 'TextualBody', value: 'The first' }, { id: 'pictures/1.png', type: 'Image' }], target: { selector: [{ type: 'PointSelector' }] } }],
};

/// `https://HOST/david.3tz` and the like, as a browser of this test opens them. `host`: of a site, with the models themselves below /bucket.
function filledIn(address, host) {
  return address
    .replace(/https:\/\/(?:HOST|example\.org)\/(?=david|NAME)/g, `${host}/bucket/`)
    .replace(/https:\/\/HOST/g, host)
    .replace(/NAME/g, 'david')
    .replace(/(models?|with|story)=URL/g, (_, key) => `${key}=${host}/${{ model: 'bucket/david.3tz', with: 'bucket/david.hier', models: 'models.json', story: 'models/david.hier.story.json' }[key]}`)
    .replace(/=(?:models\/)?a\.hier&with=(?:models\/)?b\.hier/, '=models/david.hier&with=models/david.3tz')
    .replace(/#PATH/, '#models/david.hier')
    .replace(/px,py,pz,tx,ty,tz/, '9,9,9,0,0,0')
    .replace(/…$/, '');
}

/// Returns the page's address, without what stands in front of the query.
function addressesIn(text, host) {
  const found = new Set();
  for (const [, behind] of text.matchAll(/(?:^|[\s`"'(/.a-z])((?:\?(?:models?|lang)=[^\s`"'|)<>]*|#PATH[^\s`"'|)<>]*))/gm)) found.add(filledIn(behind, host));
  return [...found].filter((behind) => !behind.endsWith('model=')).map((behind) => { // of one without a value the texts tell that it has none
    const address = behind.replace(/^\?model=david/, '?model=models/david'); // beside the page, that is
    return `${host}/index.html${address}`;
  });
}

/// Code for other pages: elements and frames.
function codesIn(text, host) {
  const found = [...text.matchAll(/<(?:iframe|meshhier-viewer) src=[^`]*?>/g)].map(([code]) => filledIn(code, host));
  return [...new Set(found)].filter((code) => !code.includes('…'));
}

class Visits {
  constructor(browser, report) {
    Object.assign(this, { browser, report });
  }

  async page() {
    const page = await this.browser.newPage(WINDOW);
    await page.addInitScript(withoutRestDetail);
    page.complaints = [];
    collectComplaints(page, page.complaints, ['error', 'warning']);
    return page;
  }

  /// `what`: whether a gallery, a model, or a model that is told; null: one of them.
  async open(name, address, what = null) {
    const page = await this.page();
    await page.goto(address);
    await page.waitForFunction(() => window.meshhier?.settled() || document.querySelector('.problem') || [...document.querySelectorAll('a.cell')].length > 0);
    const seen = await this.seen(page, what === 'story');
    const isRight = what === null ? seen.kind !== null : seen.kind === what || (what === 'model' && seen.kind === 'story');
    this.report.line(`address ${name}`, seen.messages === '' && isRight && page.complaints.length === 0, `${address}: ${seen.messages || seen.kind}; ${page.complaints.join('; ') || 'no complaints'}`);
    return page;
  }

  /// Returns what there is to see once all is quiet, and all messages.
  async seen(page, awaitsStory) {
    if (awaitsStory) {
      await page.locator('.story-card').getByRole('button').nth(2).or(page.locator('.problem')).first().waitFor();
      await page.locator('.story-mark').first().click();
      await page.waitForFunction(() => document.querySelector('.story-picture')?.complete || document.querySelector('.story-body .tool-note'));
    }
    await page.waitForTimeout(400); // a message may be late
    return page.evaluate(() => {
      const pictures = [...document.querySelectorAll('img')].filter((img) => !img.hidden && img.currentSrc && img.complete && img.naturalWidth === 0);
      const messages = [...document.querySelectorAll('.problem, .cell-problem, .tool-note')].map(({ innerText }) => innerText).concat(pictures.map(({ src }) => `${src} is no picture`));
      const kind = document.querySelector('.story-card') ? 'story' : window.meshhier.settled() ? 'model' : document.querySelector('a.cell') ? 'gallery' : null;
      return { messages: messages.join('; '), kind };
    });
  }

  async close(page) {
    await page.close();
  }

  async visit(name, address, what) {
    await this.close(await this.open(name, address, what));
  }

  /// A page of somebody else, with a frame or an element in it.
  async host(name, origin, code) {
    const page = await this.page();
    const script = code.includes('<meshhier-viewer') && !code.includes('<script') ? `<script type="module" src="${origin}/meshhier-viewer.js"></script>` : '';
    const body = `<!doctype html><link rel="icon" href="data:,"><title>host</title>${script}${code}${code.includes('<meshhier-viewer') && !code.includes('</meshhier-viewer') ? '</meshhier-viewer>' : ''}`;
    await page.route(`**/${HOST_PAGE}`, (route) => route.fulfill({ contentType: 'text/html', body }));
    await page.goto(`${origin}/${HOST_PAGE}`);
    const frame = page.frames()[1];
    if (frame) await frame.waitForFunction(() => window.meshhier?.settled() || document.querySelector('.problem'));
    else await page.waitForFunction(() => document.querySelector('meshhier-viewer').view?.stats().settled || !document.querySelector('meshhier-viewer').shadowRoot.querySelector('p').hidden);
    await page.waitForTimeout(400);
    const messages = frame
      ? await frame.evaluate(() => [...document.querySelectorAll('.problem')].map(({ innerText }) => innerText).join('; '))
      : await page.evaluate(() => [...document.querySelector('meshhier-viewer').shadowRoot.querySelectorAll('p:not([hidden])')].map(({ innerText }) => innerText).join('; '));
    this.report.line(`code ${name}`, messages === '' && page.complaints.length === 0, `${code}: ${messages || 'shown'}; ${page.complaints.join('; ') || 'no complaints'}`);
    await page.close();
  }

  /// The gallery's own links, and what the sheet "Share" has of the first model.
  async gallery(name, origin) {
    const page = await this.open(`${name}: gallery`, `${origin}/index.html`, 'gallery');
    const links = await page.locator('a.cell').evaluateAll((cells) => cells.map(({ href }) => href));
    await this.close(page);
    this.report.line(`${name}: entries`, links.length === 2, links.join(', '));
    for (const link of links) await this.visit(`${name}: entry`, link, 'story');
    await this.shared(name, origin, links.find((link) => link.includes('.hier')));
  }

  async shared(name, origin, link) {
    const page = await this.open(`${name}: to share`, link, 'story');
    await page.getByRole('button', { name: 'Share', exact: true }).click();
    const [view, frame, element] = await Promise.all(['Link to this view', 'Frame for another page', 'Element for another page'].map((field) => page.getByRole('textbox', { name: field }).inputValue()));
    await this.close(page);
    await this.visit(`${name}: link to this view`, view, 'story');
    await this.host(`${name}: frame`, origin, frame);
    await this.visit(`${name}: frame alone`, /src="([^"]*)"/.exec(frame)[1].replaceAll('&amp;', '&'), 'story');
    await this.host(`${name}: element`, origin, element);
  }

  /// A model where it lies, on a host of files: no listing knows it.
  async bucket(origin, bucket) {
    for (const model of ['david.3tz', 'david.hier', 'david.hier/']) await this.visit(`bucket: ${model}`, `${origin}/index.html?model=${bucket}/${model}`, 'model');
    await this.visit('bucket: signed', `${origin}/index.html?model=${encodeURIComponent(`${bucket}/david.3tz?signature=a&expires=1`)}`, 'model');
    await this.visit('bucket: a camera', `${origin}/index.html?model=${bucket}/david.3tz#&9,9,9,0,0,0&light=raking`, 'model');
    await this.visit('bucket: told', `${origin}/index.html?model=${bucket}/david.3tz&story=${bucket}/david.hier.story.json`, 'story');
    await this.visit('bucket: in a link', `${origin}/index.html#${bucket}/david.3tz`, 'model');
  }

  async documents(origin) {
    const texts = DOCUMENTS.map((file) => readFileSync(path.join(ROOT, file), 'utf8'));
    const addresses = [...new Set(texts.flatMap((text) => addressesIn(text, origin)))];
    const codes = [...new Set(texts.flatMap((text) => codesIn(text, origin)))];
    this.report.line('documents', addresses.length >= LEAST_FOUND && codes.length >= 2, `${addresses.length} addresses and ${codes.length} codes`);
    for (const address of addresses) await this.visit('of a document', address);
    for (const code of codes) await this.host('of a document', origin, code);
  }
}

function makeModels(work, hierarchy, archive) {
  const models = path.join(work, 'models');
  mkdirSync(path.join(models, 'pictures'), { recursive: true });
  cpSync(hierarchy, path.join(models, 'david.hier'), { recursive: true });
  cpSync(archive, path.join(models, 'david.3tz'));
  for (const name of ['david.hier', 'david.3tz']) writeFileSync(path.join(models, `${name}.story.json`), JSON.stringify(STORY));
  writeFileSync(path.join(models, 'pictures/1.png'), PIXEL);
  return models;
}

async function checkAll(browser, report, [meshhier, , viewer, hierarchy, archive]) {
  const visits = new Visits(browser, report);
  const work = mkdtempSync(path.join(tmpdir(), 'meshhier-addresses-'));
  const models = makeModels(work, hierarchy, archive);
  const [site, single] = [path.join(work, 'site'), path.join(work, 'david.html')];
  execFileSync(meshhier, ['page', models, '-o', site, '--viewer', viewer]);
  execFileSync(meshhier, ['page', path.join(models, 'david.3tz'), '-o', single, '--viewer', viewer]);
  const server = startServer(meshhier, models, '--viewer', viewer, '--cors', '*');
  const host = await serve({ '/bucket': models, '': site }, { ranges: true });
  const bare = await serve({ '': site }, { isBare: true });
  try {
    await visits.gallery('served', (await server.url).replace(/\/$/, ''));
    await visits.gallery('site', host.origin);
    await visits.bucket(host.origin, `${host.origin}/bucket`);
    for (const model of ['david.hier', 'david.3tz']) await visits.visit('a host without settings', `${bare.origin}/index.html#models/${model}`, 'story');
    await visits.documents(host.origin);
    for (const behind of ['', '#&9,9,9,0,0,0', '#&up=z']) await visits.visit('one file', pathToFileURL(single).href + behind, 'model');
  } finally {
    await server.stop();
    host.close();
    bare.close();
    rmSync(work, { recursive: true });
  }
}

const given = process.argv.slice(2);
if (given.length !== 5) {
  console.log('usage: node addresses.mjs MESHHIER PICTURES PAGE HIERARCHY.hier HIERARCHY.3tz');
  process.exit(2);
}
process.exit(await inChromium(given[1], (browser, report) => checkAll(browser, report, given)));

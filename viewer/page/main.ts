// SPDX-License-Identifier: MIT
import './style/base.css';
import './style/gallery.css';
import './style/poster.css';
import { App } from './app.js';
import { embeddedModel } from './embedded.js';
import { installHook } from './hook.js';

const embedded = embeddedModel(document);
const app = new App(document.body, embedded);
installHook(app);
app.route();

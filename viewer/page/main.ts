import './style/base.css';
import './style/gallery.css';
import { App } from './app.js';
import { installHook } from './hook.js';

const app = new App(document.body);
installHook(app);
app.route();

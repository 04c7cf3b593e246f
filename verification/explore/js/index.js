// What the player is made of; the component itself is ../player.js.
export { messages } from "./stream.js";
export { Film } from "./film.js";
export { View } from "./view.js";
export { tissue } from "./tissue.js";
export { sheet } from "./sheet.js";

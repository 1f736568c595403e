// Everything that needs three.js, in one module that is loaded when a shape is first shown.
export { jobPage } from "./ui/job_page.js";
export { setupPage } from "./ui/setup.js";
export { Stage } from "./view/stage.js";

// A button that removes something for good: it asks once, in its own place.
import { h, replace } from "../dom.js";
import { icon } from "./icons.js";

const PATIENCE = 5000; // milliseconds until it is as before

export function removeButton(title, remove, look = "quiet") {
  let timer = 0;
  const calm = () => {
    clearTimeout(timer);
    timer = 0;
    button.classList.remove("danger");
    replace(button, icon("trash", 18), title);
  };
  const button = h("button", {
    type: "button",
    class: look,
    onclick: () => {
      if (timer) {
        calm();
        return remove();
      }
      button.classList.add("danger");
      replace(button, icon("trash", 18), "Remove for good?");
      timer = setTimeout(calm, PATIENCE);
    },
    onblur: calm,
  });
  calm();
  return button;
}

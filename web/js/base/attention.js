/** What the tab of the page shows while nobody looks at the page. */

import { setAttribute } from "/web/js/base/dom.js";
import { isGrave, isOn, isSilenced, isWaiting } from "/web/js/base/error_groups.js";

const ALARM_ICON = "/web/icon_alarm.svg";
let calmIcon = null;
let counted = null;
let count = 0;

/** How many critical and fatal errors are on and unacknowledged; a silenced one waits for nobody. */
export function unseenCritical(errors) {
  if (counted === errors) return count;
  const waits = (error) =>
    isGrave(error) && isOn(error) && isWaiting(error) && !isSilenced(error);
  counted = errors;
  count = Object.values(errors).filter(waits).length;
  return count;
}

/** Show by the icon of the tab whether such errors wait; return how its title begins. */
export function attention(errors) {
  const waiting = unseenCritical(errors);
  const link = document.querySelector("link[rel=icon]");
  calmIcon ??= link.getAttribute("href");
  setAttribute(link, "href", waiting ? ALARM_ICON : calmIcon);
  return waiting ? `(${waiting}) ` : "";
}

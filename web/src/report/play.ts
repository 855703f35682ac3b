// Pictures of motions play in the page's viewer; of two viewers beside one another, each follows the other's choice.

import type { Controller, Motion, MotionKey } from "../viewer/types";

interface Place extends HTMLElement {
  flexstage?: Controller;
}

function keyOf(text: string): MotionKey {
  const [group, ...name] = text.split(" ");
  return { group: group as MotionKey["group"], name: name.join(" ") };
}

/** Plays a motion in the page's first viewer, and brings that into sight. */
export function play(motion: string): void {
  const place = document.querySelector<Place>("[data-flexstage]");
  if (!place) return;
  place.dataset["motion"] = motion; // for a viewer that has not begun yet
  place.flexstage?.setMotion(keyOf(motion));
  place.flexstage?.setPlaying(true);
  place.scrollIntoView({ block: "center", behavior: "smooth" });
}

/** Gives pictures of motions a button, where there is a viewer that plays them. */
export function addPlays(): void {
  for (const figure of document.querySelectorAll<HTMLElement>("figure[data-play]")) {
    const button = document.createElement("button");
    button.type = "button";
    button.className = "play";
    button.textContent = "\u25b6 Play";
    button.addEventListener("click", () => play(figure.dataset["play"] ?? ""));
    (figure.querySelector("figcaption") ?? figure).append(" ", button);
  }
}

/** Partners of motions, from the page: `data-partners="mode 1=mode m1;..."` on the element around two viewers. */
function partners(text: string): Map<string, string> {
  const pairs = text.split(";").map((each) => each.split("=") as [string, string]);
  return new Map(pairs.flatMap(([one, other]) => [[one, other], [other, one]]));
}

function follow(leader: Controller, follower: Place, known: Map<string, string>): void {
  leader.onMotion((motion: Motion | null) => {
    const other = motion && known.get(`${motion.group} ${motion.name}`);
    if (other) follower.flexstage?.setMotion(keyOf(other));
  });
}

/** Lets two viewers of one frame choose together. */
export function joinViewers(): void {
  for (const frame of document.querySelectorAll<HTMLElement>("[data-partners]")) {
    const known = partners(frame.dataset["partners"] ?? ""), places = [...frame.querySelectorAll<Place>("[data-flexstage]")];
    frame.addEventListener("flexstage", ({ target }) => {
      const leader = target as Place;
      for (const each of places) if (each !== leader && leader.flexstage) follow(leader.flexstage, each, known);
    });
  }
}

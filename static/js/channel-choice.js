// @ts-check
/** Which channels of a run somebody may draw, and how they are found. Pure. */
import { label } from "./format.js";

/** @typedef {import("./types.js").Channel} Channel */

/** As many curves as one figure may hold. */
export const MOST = 16;

/** Names of the groups, in the order in which they are offered. @type {Record<string, string>} */
const GROUPS = { deck: "Points", wheel: "Wheels", vehicle: "Cars and bogies", bearing: "Bearings" };

/** @param {string} name of a channel: place/quantity */
const quantityOf = (name) => name.slice(name.lastIndexOf("/") + 1);

/** @param {string} name */
export const placeOf = (name) => name.slice(0, Math.max(name.lastIndexOf("/"), 0)) || name;

/** @param {string} group */
export const groupText = (group) => GROUPS[group] ?? label(group);

/**
 * The channels that fit beside those that are drawn already.
 *
 * @param {Channel[]} channels
 * @param {{ drawn: string[], any: boolean }} options `any`: of whatever quantity
 */
export function fitting(channels, { drawn, any }) {
  const quantity = quantityOf(drawn[0] ?? "");
  return any || !quantity ? channels : channels.filter((channel) => quantityOf(channel.name) === quantity);
}

/**
 * The groups that some channels belong to.
 *
 * @param {Channel[]} channels
 */
export function groupsOf(channels) {
  const present = new Set(channels.map((channel) => channel.group));
  const known = Object.keys(GROUPS).filter((group) => present.delete(group));
  return [...known, ...present];
}

/**
 * Channels whose name or title holds every word.
 *
 * @param {Channel[]} channels
 * @param {{ text: string, group: string }} filter an empty group stands for all
 */
export function found(channels, { text, group }) {
  const words = text.toLowerCase().split(/\s+/).filter(Boolean);
  return channels.filter((channel) => {
    if (group && channel.group !== group) return false;
    const said = `${channel.name} ${channel.title}`.toLowerCase();
    return words.every((word) => said.includes(word));
  });
}

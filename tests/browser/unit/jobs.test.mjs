// What the page knows of its jobs, when answers and events cross.
import assert from "node:assert/strict";
import { it } from "node:test";
import { jobs } from "../../../web/src/jobs.js";

const at = (second) => `2026-03-01T10:00:0${second}.000Z`;
const job = (status, second) => ({ jobID: "j", status, created: at(0), updated: at(second) });

it("an answer that an event has overtaken takes nothing back", () => {
  jobs.put(job("failed", 2));
  jobs.put(job("accepted", 1));
  assert.equal(jobs.get("j").status, "failed");
});

it("within a millisecond the later status counts", () => {
  jobs.put(job("running", 3));
  jobs.put(job("successful", 3));
  jobs.put(job("running", 3));
  assert.equal(jobs.get("j").status, "successful");
});

it("a retry begins anew", () => {
  jobs.put(job("accepted", 4));
  assert.equal(jobs.get("j").status, "accepted");
  jobs.drop("j");
});

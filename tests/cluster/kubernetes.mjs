// scripts/cluster/kubernetes.yaml without a cluster: the schemas of Argo's Workflow and of Kubernetes' Job hold, and the
// commands in it, run as the controllers would run them, make the bytes of a build on one machine.
//
//   node tests/cluster/kubernetes.mjs MESHHIER MESH FOLDER
//
// What is not tried: the controllers themselves, whether pods are placed, mounts, and failures of pods.
import { Workflow } from "@kubernetes-models/argo-workflows/argoproj.io/v1alpha1/Workflow";
import { Job } from "kubernetes-models/batch/v1/Job";
import { execFileSync } from "node:child_process";
import fs from "node:fs";
import path from "node:path";
import { parse } from "yaml";

const [program, mesh, folder] = process.argv.slice(2);
// Of a pod /tmp is its own.
const pod = path.join(folder, "tmp/");
const text = fs.readFileSync(new URL("../../scripts/cluster/kubernetes.yaml", import.meta.url), "utf8")
  .replaceAll("/tmp/", pod);

function require_true(holds, what) {
  if (!holds) {
    console.error(`kubernetes: FAILED: ${what}`);
    process.exit(1);
  }
}

const workflow = parse(text);
new Workflow(workflow).validate();
const templates = new Map(workflow.spec.templates.map((template) => [template.name, template]));
const parameters = {
  mesh, output: path.join(folder, "pods.hier"), work: path.join(folder, "pods.work"), tasks: "5",
  image: "registry.example.org/meshhier:0.1.0", volume: "scans",
};
for (const { name, value } of workflow.spec.arguments.parameters) {
  require_true(value !== undefined || parameters[name] !== undefined, `parameter ${name} is documented`);
  parameters[name] ??= value;
}

function filled(template, inputs = {}) {
  const result = template
    .replaceAll(/\{\{workflow\.parameters\.(\w+)\}\}/g, (_, name) => parameters[name])
    .replaceAll(/\{\{inputs\.parameters\.(\w+)\}\}/g, (_, name) => inputs[name]);
  require_true(!result.includes("{{"), `nothing is left to be filled in: ${result}`);
  return result;
}

fs.mkdirSync(pod, { recursive: true });
const bin = path.join(folder, "bin");
fs.mkdirSync(bin, { recursive: true });
fs.symlinkSync(program, path.join(bin, "meshhier"));

function run(container, environment = {}, inputs = {}) {
  const [command, ...fixed] = container.command;
  const args = [...fixed, ...container.args].map((argument) => filled(String(argument), inputs));
  return execFileSync(command, args, {
    env: { PATH: `${bin}:${process.env.PATH}`, ...environment },
    encoding: "utf8",
  });
}

run(templates.get("plan").container);
const ran = [];
for (;;) {
  run(templates.get("next").container);
  const [stage, count] = ["stage", "count"].map((name) => fs.readFileSync(`${pod}${name}`, "utf8").trim());
  if (stage === "") break;
  require_true(!ran.includes(stage), `stage ${stage} is complete after its Job`);
  ran.push(stage);
  const { resource } = templates.get("stage");
  const inputs = { stage, count };
  const job = parse(filled(resource.manifest, inputs));
  new Job(job).validate();
  require_true(filled(resource.successCondition, inputs) === `status.succeeded == ${job.spec.completions}`,
    "the stage waits for all its pods");
  const [container] = job.spec.template.spec.containers;
  const failing = job.spec.podFailurePolicy.rules.find((rule) => rule.action === "FailJob");
  require_true(failing.onExitCodes.containerName === container.name, "the policy is of the container");
  // The last first: pods start in any order.
  for (let index = job.spec.completions - 1; index >= 0; --index)
    run(container, { JOB_COMPLETION_INDEX: String(index) }, inputs);
}
require_true(ran[0] === "read" && ran.at(-1) === "finish", "stages run from read to finish");
console.log(`kubernetes: the schemas hold; ${ran.length} stages ran as pods would`);

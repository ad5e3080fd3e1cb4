"""Config to tables and figures: sample -> solve -> [measure ->] collect -> summarise -> figures.

Shards and stamps are named by their content, so a file that exists is up to date: adding a value, a method or a scene
computes only what is new, whatever the clocks say. The designs are sampled while this file is read, because the shards
they need decide the graph; every other step is a rule, and each rule is one `cablesim` command.
"""

from pathlib import Path

from cablesim.workflow import plan_study

study = plan_study(
    (workflow.configfiles or [Path("config/config.yaml")])[-1],
    checking=workflow.is_main_process,
    holding=workflow.is_main_process and not workflow.dryrun,
)

# What takes the whole machine comes first; then what makes results of what is solved; then solving, the longest first,
# so that no core is left with a long job at the end; and last catalogue and page, which nothing waits for.
ALONE, SOON, LAST = 1e9, 1e6, -1


wildcard_constraints:
    scene="[a-z][a-z0-9_]*",
    bundle="[0-9a-f]{24}",


rule all:
    default_target: True
    input:
        study.catalogue_stamp,
        study.report_stamp,
        [scene.solved for scene in study.scenes],
        [
            scene.stamp(step)
            for scene in study.scenes
            for step in ("summarise", "figures")
        ],


include: "workflow/rules/solve.smk"
include: "workflow/rules/scene.smk"
include: "workflow/rules/study.smk"

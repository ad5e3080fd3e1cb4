# From shards to dataset, tables and figures: one rule of each kind for each scene, with all its paths written out.
# Inputs are `ancient`: names tell what is up to date, so no clock is asked.

for scene in study.scenes:

    if scene.timings:

        # Alone on the machine, because it takes times.
        rule:
            name:
                f"measure_{scene.name}"
            output:
                scene.timings,
            log:
                f"{study.results}/logs/measure/{scene.name}.log",
            priority: ALONE
            threads: workflow.cores
            params:
                scene=scene.path,
                results=study.results,
            shell:
                "{study.python:q} -m cablesim step measure {params.scene:q} {params.results:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"collect_{scene.name}"
        input:
            ancient(scene.solved + scene.timings),
        output:
            dataset=scene.dataset,
            stamp=scene.stamp("collect"),
        log:
            f"{study.results}/logs/collect/{scene.name}.log",
        priority: SOON
        params:
            scene=scene.path,
            results=study.results,
        shell:
            "{study.python:q} -m cablesim step collect {params.scene:q} {params.results:q} --stamp {output.stamp:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"summarise_{scene.name}"
        input:
            ancient(scene.stamp("collect")),
        output:
            scene.stamp("summarise"),
        log:
            f"{study.results}/logs/summarise/{scene.name}.log",
        priority: SOON
        params:
            scene=scene.path,
            results=study.results,
        shell:
            "{study.python:q} -m cablesim step summarise {params.scene:q} {params.results:q} --stamp {output:q} 2>&1 | tee {log:q}"

    rule:
        name:
            f"figures_{scene.name}"
        input:
            ancient(scene.stamp("collect")),
        output:
            scene.stamp("figures"),
        log:
            f"{study.results}/logs/figures/{scene.name}.log",
        priority: SOON
        params:
            scene=scene.path,
            results=study.results,
        shell:
            "{study.python:q} -m cablesim step figures {params.scene:q} {params.results:q} --stamp {output:q} 2>&1 | tee {log:q}"

# What all scenes hold, in one file, when all are collected.


rule catalogue:
    input:
        ancient([scene.stamp("collect") for scene in study.scenes]),
    output:
        study.catalogue_stamp,
    log:
        f"{study.results}/logs/catalogue.log",
    priority: LAST
    params:
        results=study.results,
    shell:
        "{study.python:q} -m cablesim step catalogue {params.results:q} --stamp {output:q} 2>&1 | tee {log:q}"

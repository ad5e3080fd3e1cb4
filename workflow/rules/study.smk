# What is of the whole study: the catalogue of what all scenes hold, and the page that shows it.


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


rule report:
    input:
        ancient([scene.stamp("summarise") for scene in study.scenes]),
    output:
        study.report_stamp,
    log:
        f"{study.results}/logs/report.log",
    priority: LAST
    params:
        config=study.config,
        results=study.results,
    shell:
        "{study.python:q} -m cablesim step report {params.config:q} {params.results:q} --stamp {output:q} 2>&1 | tee {log:q}"

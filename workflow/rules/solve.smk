# One job for each bundle of shards that is worth its start; shards that are there already are kept.


rule solve:
    output:
        f"{study.results}/stamps/{{scene}}.solve.{{bundle}}",
    log:
        f"{study.results}/logs/solve/{{scene}}-{{bundle}}.log",
    priority: lambda wildcards: study.scene(wildcards.scene).bundle_seconds(wildcards.bundle)
    params:
        plan=lambda wildcards: study.scene(wildcards.scene).plan,
        folder=lambda wildcards: study.scene(wildcards.scene).shards,
        shards=lambda wildcards: study.scene(wildcards.scene).bundles[wildcards.bundle],
    shell:
        "{study.python:q} -m cablesim step solve {params.plan:q} {params.folder:q} {params.shards} --stamp {output:q} 2>&1 | tee {log:q}"

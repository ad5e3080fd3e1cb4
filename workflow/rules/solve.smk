# One job for each shard: a block of a scene's design, solved by one method.


rule solve:
    output:
        shard=f"{study.results}/shards/{{scene}}/{{shard}}.nc",
        ledger=f"{study.results}/shards/{{scene}}/{{shard}}.nc.sha256",
    log:
        f"{study.results}/logs/solve/{{scene}}-{{shard}}.log",
    params:
        plan=lambda wildcards: study.scene(wildcards.scene).plan,
        method=lambda wildcards: study.scene(wildcards.scene).method_of(wildcards.shard),
    message:
        "solve {wildcards.scene} ({params.method}), shard {wildcards.shard}; log {log}"
    shell:
        "{study.python:q} -m cablesim step solve {params.plan:q} {wildcards.shard} {output.shard:q} 2> {log:q}"

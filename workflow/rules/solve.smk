# One job for each shard: a block of a scene's design, solved by one method.


rule solve:
    output:
        shard=f"{study.results}/shards/{{scene}}/{{shard}}.nc",
        ledger=f"{study.results}/shards/{{scene}}/{{shard}}.json",
    log:
        f"{study.results}/logs/solve/{{scene}}-{{shard}}.log",
    params:
        plan=lambda wildcards: study.scene(wildcards.scene).plan,
    shell:
        "{study.python:q} -m cablesim step solve {params.plan:q} {wildcards.shard} {output.shard:q} 2>&1 | tee {log:q}"

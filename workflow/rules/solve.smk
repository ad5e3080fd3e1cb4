# One job for each shard: a block of a scene's design, solved by one method.


rule solve:
    output:
        shard=f"{study.results}/shards/{{scene}}/{{shard}}.nc",
        ledger=f"{study.results}/shards/{{scene}}/{{shard}}.nc.sha256",
    params:
        plan=lambda wildcards: study.scene(wildcards.scene).plan,
        method=lambda wildcards: study.scene(wildcards.scene).method_of(wildcards.shard),
    log:
        f"{study.results}/logs/solve/{{scene}}-{{shard}}.log",
    message:
        "solve {wildcards.scene} ({params.method}), shard {wildcards.shard}; log {log}"
    shell:
        "python -m cablesim step solve {params.plan:q} {wildcards.shard} {output.shard:q} 2> {log:q}"



rule STAGE:
    input:
        needs("STAGE"),
    output:
        STAMPS + "/STAGE-{key}",
    params:
        id=task("STAGE"),
    message:
        "{params.id}"
    shell:
        COMMAND

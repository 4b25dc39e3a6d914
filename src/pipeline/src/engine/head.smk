
# Asked anew each time: a task of which anything has changed has another stamp.
LISTED = [SIGNORINI, "dag", "--json", "--cache-dir", CACHE]
TASKS = json.loads(subprocess.run(LISTED, check=True, stdout=subprocess.PIPE).stdout)["tasks"]
STAMP_OF = {task["id"]: task["stamp"] for task in TASKS}
TASK_OF = {os.path.basename(task["stamp"]): task for task in TASKS}
STAMPS = os.path.dirname(TASKS[0]["stamp"])
COMMAND = "RAYON_NUM_THREADS={threads} {SIGNORINI:q} run --quiet --cache-dir {CACHE:q} --task {params.id:q}"


def needs(stage):
    return lambda wildcards: [STAMP_OF[id] for id in TASK_OF[f"{stage}-{wildcards.key}"]["needs"]]


def task(stage):
    return lambda wildcards: TASK_OF[f"{stage}-{wildcards.key}"]["id"]


rule all:
    input:
        list(STAMP_OF.values()),

"""Reads an RO-Crate as others read it: opens it with `rocrate`, and validates it with `roc-validator`.

Argument: the folder of the crate. The validator looks up the JSON-LD context on the network; it is given the one that
`rocrate` brings along instead, so that nothing is fetched.
"""

import json
import sys
from importlib.resources import files

from rocrate.rocrate import ROCrate
from rocrate_validator import models, services
from rocrate_validator.utils.http import HttpRequester

CONTEXT = json.loads(files("rocrate").joinpath("data/ro-crate.jsonld").read_text("utf8"))


class Context:
    """The answer to every request."""

    status_code = 200
    headers = {"Content-Type": "application/ld+json"}
    text = json.dumps(CONTEXT)

    def json(self):
        return CONTEXT


class Session:
    def get(self, url, **_):
        if url != "https://w3id.org/ro/crate/1.1/context":
            raise RuntimeError(f"{url} is asked for")
        return Context()


folder = sys.argv[1]
crate = ROCrate(folder)
action = crate.get("#run")
for entity in [action["instrument"], *action["object"], *action["result"]]:
    assert entity.type in ("File", "SoftwareApplication"), entity

settings = models.ValidationSettings(
    rocrate_uri=folder,
    profile_identifier="process-run-crate-0.5",
    requirement_severity=models.Severity.REQUIRED,
)
HttpRequester().session = Session()
result = services.validate(settings)
for issue in result.get_issues():
    print(issue.severity.name, issue.check.identifier, issue.message)
sys.exit(0 if result.passed() else 1)

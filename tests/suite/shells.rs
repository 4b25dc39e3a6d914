//! Completions, as the shells themselves give them.

use crate::common::{Project, TABLE, skip};
use std::fs;
use std::process::Command;

/// Zsh on a terminal of its own, told to complete two lines; the lines that it offers come before the marks.
const ZSH: &str = r#"
zmodload zsh/zpty || exit 1
zpty shell 'TERM=dumb zsh -f -i'
zpty -w shell 'autoload -Uz compinit; compinit -u -D; source ./_signorini; LISTMAX=0; PS1=REA; PS1+="DY> "'
zpty -r shell seen '*READY> *'
zpty -n -w shell $'signorini s\t\t\C-uprint -r -- MARK$((1+1))\n'
zpty -r shell seen '*MARK2*READY> *'
print -r -- "$seen"
print COMMANDS
zpty -n -w shell $'signorini solve --solver \t\t\C-uprint -r -- MARK$((1+2))\n'
zpty -r shell seen '*MARK3*READY> *'
print -r -- "$seen"
zpty -n -w shell $'signorini solve --domain \t\t\C-uprint -r -- MARK$((1+3))\n'
zpty -r shell seen '*MARK4*'
print -r -- "$seen"
zpty -d shell
"#;

const BASH: &str = r#"
source ./_signorini
COMP_WORDS=(signorini s) COMP_CWORD=1; _signorini signorini s signorini
printf '%s\n' "${COMPREPLY[@]}" COMMANDS
COMP_WORDS=(signorini solve --solver '') COMP_CWORD=3; _signorini signorini '' --solver
printf '%s\n' "${COMPREPLY[@]}"
COMP_WORDS=(signorini solve --domain '') COMP_CWORD=3; _signorini signorini '' --domain
printf '%s\n' "${COMPREPLY[@]}"
COMP_WORDS=(signorini solve --stop '') COMP_CWORD=3; _signorini signorini '' --stop
printf '%s\n' "${COMPREPLY[@]}"
"#;

const FISH: &str = r"
source ./_signorini
complete -C 'signorini s'
echo COMMANDS
complete -C 'signorini solve --solver '
complete -C 'signorini solve --domain '
complete -C 'signorini solve --domain ow'
complete -C 'signorini solve --stop '
";

#[test]
fn each_shell_completes_commands_and_their_options() {
    let project = Project::with(TABLE);
    for (shell, script) in [("zsh", ZSH), ("bash", BASH), ("fish", FISH)] {
        let completions = project.run(&["completions", shell]);
        completions.lines();
        project.write("_signorini", &completions.out);
        project.write("script", script);
        project.write("own.msh", "");
        // A shell that waits for ever is a failure.
        let mut command = Command::new("timeout");
        command.args(["600", shell, "script"]).current_dir(project.path("."));
        let said = command.output().unwrap();
        if said.status.code() == Some(127) {
            skip(&format!("{shell} is not installed"));
            continue;
        }
        let text = String::from_utf8_lossy(&said.stdout).into_owned();
        assert!(said.status.success(), "{shell}: {said:?}");
        let (commands, solvers) = text.split_once("COMMANDS").unwrap();
        for name in ["solve", "status"] {
            assert!(commands.contains(name), "{shell}: {text}");
        }
        // What `s` begins on every system.
        for other in ["sleep", "sort", "stty"] {
            assert!(!commands.contains(other), "{shell}: {text}");
        }
        for name in ["arrow-hurwicz", "multigrid"] {
            assert!(solvers.contains(name), "{shell}: {text}");
        }
        // Zsh is asked for less: each question takes it a second.
        for name in ["lshape", "printed-dual"] {
            let asked = shell != "zsh" || name == "lshape";
            assert!(!asked || solvers.contains(name), "{shell}: {text}");
        }
        // Bash falls back to files by itself.
        assert!(shell == "bash" || solvers.contains("own.msh"), "{shell}: {text}");
        fs::remove_file(project.path("_signorini")).unwrap();
    }
}

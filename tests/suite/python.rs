//! What calls the program from Python: what it returns, what it raises, and the notebook.

use crate::common::{Said, skip};
use std::process::{Command, Output};

/// Runs Python with the module of this project and the program that the tests built; none without NumPy.
pub(crate) fn python(args: &[&str]) -> Option<Output> {
    let run = |args: &[&str]| {
        let mut command = Command::new("python3");
        command
            .args(args)
            .current_dir(env!("CARGO_MANIFEST_DIR"))
            .env("PYTHONDONTWRITEBYTECODE", "1");
        command.env("PYTHONPATH", "src/python").env("SIGNORINI", env!("CARGO_BIN_EXE_signorini"));
        command.output()
    };
    if !run(&["-c", "import numpy"]).is_ok_and(|found| found.status.success()) {
        skip("no python3 with numpy");
        return None;
    }
    Some(run(args).unwrap())
}

#[test]
fn the_notebook_has_the_outputs_that_it_keeps() {
    let Some(output) = python(&["tests/notebook.py", "src/python/signorini.ipynb"]) else { return };
    let said = Said::from(output);
    assert_eq!(said.lines(), ["5 cells"]);
}

#[test]
fn python_varies_values_of_any_kind() {
    let program = "import signorini\n\
        f = 'disc(0,0,$R)=4; else=-1'\n\
        print(signorini.study({'R': 0.1, 'h': [8, '1/16']}, f=f)['h'])\n\
        print(signorini.study({'grids': ['4,8']}, f='else=-1')['grids'])\n\
        print(signorini.study({'solver': 'multigrid'}, f='else=-1', h=8)['solver'])\n\
        print(signorini.study({'f': ['else=-1', 'formula(min(x,y) - 1)']}, h=8)['f'])\n\
        print(signorini.study({'fixed': [['inner', 'outer'], []]}, f='else=-1', domain='annulus', refine=0)['fixed'])\n\
        a = signorini.study({'a': [-2, 3]}, f='formula($a^2 - 6)', h=8)\n\
        print(a['a'], a['energy'][0] == signorini.solve(f='formula(4 - 6)', h=8).energy)\n\
        for vary in [{}, {'R': ['a|b']}, {'R': [None]}]:\n\
        \x20   try: signorini.study(vary, f=f)\n\
        \x20   except signorini.Refused as e: print(e)\n";
    let Some(output) = python(&["-c", program]) else { return };
    let said = Said::from(output);
    let want = [
        "[0.125  0.0625]",
        "['4,8']",
        "['multigrid']",
        "['else=-1' 'formula(min(x, y) - 1)']",
        "['inner,outer' '']",
        "[-2  3] True",
        "nothing is varied; give the values of an option, as in study({\"friction\": [0.2, 0.4]}, f=F)",
        "R: a value with | cannot be varied; solve it alone",
        "--vary R=None: a name in f is a number, such as 0.25 or 1/4; what is no number varies as a field, as f does",
    ];
    assert_eq!(said.lines(), want);
}

#[test]
fn python_raises_the_line_of_the_program() {
    let program = "import signorini\n\
        try: signorini.solve(f='else=1')\n\
        except signorini.Refused as e: print(e)\n\
        square = signorini.solve(f='rect(-0.5,0.5,-0.5,0)=-3; else=1', h='1/8')\n\
        middles = square.points[square.cells].mean(axis=1)\n\
        print(((middles[:, 1] < 0) == (square.f == -3)).all(), square.v.shape, square.multiplier.shape)\n\
        at = signorini.solve(f='else=-1', h=8, at=[(0, 0), (9, 9)])\n\
        print(at, [value['v'] for value in at.values])\n\
        none = signorini.study({'friction': [0.01]}, f='else=-1')\n\
        print(none['energy'], none['reason'][0][:15])\n";
    let Some(output) = python(&["-c", program]) else { return };
    let said = Said::from(output);
    let want = [
        "the integral of f is 1.000, but the flux through the boundary can only balance a negative one; lower f somewhere",
        "True (81,) (81,)",
        "<solution, else=-1, energy -0.01671152, 81 nodes> [-0.0727826286764706, None]",
        "[nan] the integral of",
    ];
    assert_eq!(said.lines(), want);
}

#[test]
fn python_says_what_is_wrong_and_returns_what_is_reached() {
    let program = "import os, signorini\n\
        def said(call, *names, **options):\n\
        \x20   try: print(call(*names, **options))\n\
        \x20   except signorini.Refused as refused: print(refused)\n\
        f = 'else=-1'\n\
        said(signorini.solve, f=f, hh=8)\n\
        said(signorini.solve, f=f, solver='multgrid')\n\
        said(signorini.picture, f=f, view='contour')\n\
        said(signorini.solve, f=f, out='v.svg')\n\
        partial = signorini.solve(f=f, domain='disc', accuracy=1e-4, most_nodes=500)\n\
        print(partial.failure.split(':')[0], partial.v.shape[0] < 500)\n\
        print(signorini.study({'grids': ['4,8']}, f=f)['nodes'])\n\
        at = signorini.solve(f=f, h='1/8', at=[(0.1, 0.2), (0, 0)]).answer['values']\n\
        print([value['point'] for value in at])\n\
        print(signorini.solve(f=f, domain='annulus', refine=1, curve={'inner': (0, 0, 0.5)}).failure)\n\
        os.environ['SIGNORINI'] = '/none'\n\
        said(signorini.solve, f=f)\n";
    let Some(output) = python(&["-c", program]) else { return };
    let text = String::from_utf8(output.stdout).unwrap();
    let want = [
        "unexpected argument '--hh' found; tip: a similar argument exists: '--h'",
        "--solver multgrid: choose one of arrow-hurwicz, uzawa, uzawa-loose, uzawa-proximal, active-set, multigrid, \
         spectral",
        "view 'contour': choose one of map, surface, mesh",
        "out: the answer is returned; leave it out, and write what is returned",
        "the accuracy 0.0001 is not reached True",
        "[81]",
        "[[0.1, 0.2], [0.0, 0.0]]",
        "None",
        "/none: No such file or directory; name the program by the variable SIGNORINI",
    ];
    assert_eq!(
        text.lines().collect::<Vec<_>>(),
        want,
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
}

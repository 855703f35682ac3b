"""`python -m flexstage`: the command line, if the script `flexstage` is not on the PATH."""

from flexstage.apps.cli import main

if __name__ == "__main__":
    main()

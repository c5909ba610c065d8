#!/usr/bin/env python3
"""The man page and the shells' completions of girih, from what the program itself says of its commands.

Usage: manual.py PROGRAM VERSION MAN BASH ZSH FISH: runs PROGRAM and writes the four files.
"""
import os
import re
import subprocess
import sys


class Option:
    def __init__(self, letter, name, argument, text):
        self.letter, self.name, self.argument, self.text = letter, name, argument, text

    def choices(self):
        """Words that it takes; those in capitals stand for something else."""
        return [word for word in self.argument.split("|") if word and not re.search("[A-Z']", word)]

    def takes_file(self):
        return bool(re.search(r"\b(FILE|MAP|FOLDER)\b", self.argument))


class Command:
    """What --help prints: usage, a description, groups of options, examples."""

    def __init__(self, name, summary, text):
        self.name, self.summary = name, summary
        lines = text.splitlines()
        self.usage = lines[0].removeprefix("Usage: ").strip()
        self.description, self.groups, self.examples = [], [["Options", []]], []
        at = 1
        while at < len(lines) and not re.match(r"\s+-", lines[at]) and not lines[at].startswith(" "):
            self.description.append(lines[at])
            at += 1
        self.description = " ".join(" ".join(self.description).split())
        while at < len(lines) and not lines[at].startswith("Examples:"):
            line = lines[at]
            option = re.match(r"\s+(?:-(\S), )?--([a-z-]+)(?:=(.*?))?(?:\s{2,}(.*))?$", line)
            if option:
                letter, name, argument, words = option.groups()
                self.groups[-1][1].append(Option(letter, name, argument or "", words or ""))
            elif re.match(r"\s{10,}\S", line):  # the text of an option too long for its line
                self.groups[-1][1][-1].text = line.strip()
            elif re.match(r" \S.*:$", line):
                self.groups.append([line.strip(" :"), []])
            at += 1
        self.examples = [line.strip() for line in lines[at + 1:] if line.strip()]

    def options(self):
        return [option for _, options in self.groups for option in options]


def ask(program, *arguments):
    environment = dict(os.environ, ARGP_HELP_FMT="rmargin=4000,opt-doc-col=70", LC_ALL="C")
    return subprocess.run([program, *arguments], env=environment, check=True, text=True,
                          stdout=subprocess.PIPE).stdout


def read_commands(program):
    overview = ask(program, "--help")
    commands = []
    for name, summary in re.findall(r"^  ([a-z]+) +(\S.*)$", overview, re.MULTILINE):
        if name != "girih":
            commands.append(Command(name, summary, ask(program, name, "--help")))
    return commands


def roff(text):
    text = text.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + text if text.startswith(".") else text


def man_page(commands, version):
    out = [f'.TH GIRIH 1 "" "girih {version}" "User Commands"',
           ".SH NAME", "girih \\- adaptive, crack\\-free tessellation of glTF models",
           ".SH SYNOPSIS"]
    for command in commands:
        out += [".br", roff(command.usage)]
    out += [".SH COMMANDS"]
    for command in commands:
        out += [f'.SS "girih {command.name}: {roff(command.summary)}"', roff(command.description)]
        for title, options in command.groups:
            if title != "Options" and options:
                out += [".PP", f"\\fI{roff(title)}\\fR"]
            for option in options:
                names = f"\\-{option.letter}, " if option.letter else ""
                names += f"\\-\\-{roff(option.name)}"
                out += [".TP", f"\\fB{names}\\fR" + (f"=\\fI{roff(option.argument)}\\fR" if option.argument else ""),
                        roff(option.text)]
        if command.examples:
            out += [".PP", "Examples:", ".PP", ".nf", *map(roff, command.examples), ".fi"]
    out += [".SH EXIT STATUS", "0: done. 1: failed on this input. 2: wrong use.",
            ".SH ENVIRONMENT", ".TP", "\\fBNO_COLOR\\fR", "No colours, also not on a terminal.",
            ".TP", "\\fBGIRIH_VALIDATION\\fR", "1: as \\-\\-validation."]
    return "\n".join(out) + "\n"


def bash_completion(commands):
    names = " ".join(command.name for command in commands)
    out = ["# bash completion of girih",
           "_girih() {",
           '    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} options',
           "    COMPREPLY=()",
           "    # Bash splits --option=word at the =.",
           '    if [[ $word == "=" ]]; then',
           "        word=",
           '    elif [[ $before == "=" ]]; then',
           '        before=${COMP_WORDS[COMP_CWORD - 2]}',
           "    fi",
           "    if ((COMP_CWORD == 1)); then",
           f'        mapfile -t COMPREPLY < <(compgen -W "{names} help --help --version" -- "$word")',
           "        return",
           "    fi",
           '    if [[ ${COMP_WORDS[1]} == help ]]; then',
           f'        mapfile -t COMPREPLY < <(compgen -W "{names}" -- "$word")',
           "        return",
           "    fi",
           '    case "${COMP_WORDS[1]} $before" in']
    for command in commands:
        for option in command.options():
            words = f'"{command.name} --{option.name}"' + (f' | "{command.name} -{option.letter}"' if option.letter else "")
            choices = option.choices()
            if choices:
                files = ' -f' if option.takes_file() else ""
                out += [f"    {words})",
                        f'        mapfile -t COMPREPLY < <(compgen{files} -W "{" ".join(choices)}" -- "$word")',
                        "        return", "        ;;"]
            elif option.argument and not option.takes_file():
                out += [f"    {words})", "        return", "        ;;"]
    out += ["    esac", '    case "${COMP_WORDS[1]}" in']
    for command in commands:
        out += [f"    {command.name})",
                f'        options="{" ".join("--" + option.name for option in command.options())}"', "        ;;"]
    out += ["    *) return ;;", "    esac",
            '    if [[ $word == -* ]]; then',
            '        mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")',
            "    else",
            '        mapfile -t COMPREPLY < <(compgen -f -- "$word")',
            "    fi",
            "}",
            "complete -o filenames -F _girih girih"]
    return "\n".join(out) + "\n"


def quoted(text):
    return "'" + text.replace("'", "'\\''") + "'"


def zsh_completion(commands):
    out = ["#compdef girih", "_girih() {", "    local -a commands", "    commands=("]
    out += [f"        {quoted(command.name + ':' + command.summary.replace(':', ' '))}" for command in commands]
    out += ["        'help:tell of a command'", "    )",
            "    if ((CURRENT == 2)); then", "        _describe command commands", "        return", "    fi",
            "    local command=${words[2]}", "    shift words", "    ((CURRENT--))", '    case "$command" in',
            "    help) _describe command commands ;;"]
    for command in commands:
        out += [f"    {command.name})", "        _arguments \\"]
        for option in command.options():
            text = re.sub(r"[\[\]:]", " ", option.text)
            action = ""
            if option.argument:
                choices = option.choices()
                what = f"({' '.join(choices)})" if choices else "_files" if option.takes_file() else ""
                action = f":{re.sub(':', ' ', option.argument)}:{what}"
            separator = "=" if option.argument else ""
            out += [f"            {quoted(f'--{option.name}{separator}[{text}]{action}')} \\"]
        out += ["            '*:file:_files'", "        ;;"]
    out += ["    esac", "}", '_girih "$@"']
    return "\n".join(out) + "\n"


def fish_completion(commands):
    names = " ".join(command.name for command in commands)
    out = ["# fish completion of girih"]
    for command in commands:
        out += [f"complete -c girih -f -n 'not __fish_seen_subcommand_from {names}' -a {command.name} "
                f"-d {quoted(command.summary)}"]
    for command in commands:
        for option in command.options():
            line = f"complete -c girih -n '__fish_seen_subcommand_from {command.name}' -l {option.name}"
            line += f" -s {option.letter}" if option.letter and option.letter.isalnum() else ""
            if option.argument:
                line += " -r" if option.takes_file() else " -x"
                if option.choices():
                    line += f" -a {quoted(' '.join(option.choices()))}"
            out += [line + f" -d {quoted(option.text.split('. ')[0])}"]
    return "\n".join(out) + "\n"


def main():
    program, version, man, bash, zsh, fish = sys.argv[1:]
    commands = read_commands(program)
    for path, text in ((man, man_page(commands, version)), (bash, bash_completion(commands)),
                       (zsh, zsh_completion(commands)), (fish, fish_completion(commands))):
        with open(path, "w", encoding="utf-8") as file:
            file.write(text)


if __name__ == "__main__":
    main()

# Completion of atrium: the names of commands, then what the command itself completes.
_atrium() {
    local folder name
    folder=$(dirname "$(readlink -f "$(command -v "${COMP_WORDS[0]}")")")
    if [ "$COMP_CWORD" -eq 1 ] || { [ "$COMP_CWORD" -eq 2 ] && [ "${COMP_WORDS[1]}" = help ]; }; then
        local names=""
        for name in "$folder"/atrium-*; do
            [ -x "$name" ] && names+=" ${name##*/atrium-}"
        done
        [ "$COMP_CWORD" -eq 1 ] && names+=" help --help --version"
        mapfile -t COMPREPLY < <(compgen -W "$names" -- "${COMP_WORDS[COMP_CWORD]}")
        return
    fi
    name="atrium-${COMP_WORDS[1]}"
    if ! declare -F "_${name//-/_}" >/dev/null; then
        local file=/usr/share/bash-completion/completions/$name
        [ -r "$file" ] || return
        # shellcheck disable=SC1090
        . "$file"
    fi
    COMP_WORDS=("$name" "${COMP_WORDS[@]:2}")
    COMP_CWORD=$((COMP_CWORD - 1))
    "_${name//-/_}"
}
complete -o default -F _atrium atrium

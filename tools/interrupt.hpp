#pragma once

namespace brace {

// Ctrl-C during a long command: noted, asked for by the command, and passed on once everything is cleaned up.

/// From now on the first SIGINT, SIGTERM or SIGHUP is only noted; a second one ends the program at once.
void note_interrupts();

/// Whether one came.
bool interrupted();

/// Ends the program by the noted signal, as the shell or script that started it expects.
[[noreturn]] void end_by_noted_signal();

}  // namespace brace

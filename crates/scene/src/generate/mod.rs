//! The commands that scene files may name: `!xform`, `!genbox`, `!gensky`, `!gendaylit`, run here and never by a shell.

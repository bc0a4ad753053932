"""FMUs of others: their archives are looked at before they are unpacked, their code runs in a process of its own."""

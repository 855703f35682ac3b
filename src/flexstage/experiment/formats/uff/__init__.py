"""Universal files: functions at nodal degrees of freedom (data set 58), in ASCII and in binary."""

# Checks of the package as a whole, and of a package that builds on it.
perennial_check(layering ${PYTHON_EXECUTABLE} ${package}/layering_test.py ${PROJECT_SOURCE_DIR})
perennial_check(libraries_free_of_ros ${package}/free_of_ros_test.sh
  $<TARGET_FILE:perennial_core> $<TARGET_FILE:perennial_park>)
perennial_check(lint ${package}/lint_test.sh
  ${PROJECT_SOURCE_DIR} ${PROJECT_SOURCE_DIR}/examples/perennial_example_strategy)
perennial_check(launch_examples ${PYTHON_EXECUTABLE} ${package}/launch_examples_test.py ${PROJECT_SOURCE_DIR})
perennial_check(install_space ${package}/install_space_test.sh
  ${CMAKE_BINARY_DIR} ${CATKIN_DEVEL_PREFIX} ${CMAKE_INSTALL_PREFIX})

# A user's own strategy, in a package of its own, against this one as it was built.
set(example perennial_example_strategy)
set(example_result example-${example}.xml)
catkin_run_tests_target(example ${example} ${example_result}
  COMMAND "${CMAKE_CURRENT_SOURCE_DIR}/run_example.sh ${CATKIN_DEVEL_PREFIX}/setup.sh ${PROJECT_SOURCE_DIR}/examples/${example} ${CMAKE_CURRENT_BINARY_DIR}/example_workspace ${CATKIN_TEST_RESULTS_DIR}/${PROJECT_NAME}/${example_result}"
  DEPENDENCIES perennial_core perennial_evaluation perennial_park perennial_ros perennial_strategies
)
